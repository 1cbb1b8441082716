#pragma once

#include "formats/xml_tree.h"

#include <map>
#include <string>
#include <string_view>

namespace faceta::xml {

/// The `$name` substitutions of a scene: -D defines and <default>s.
class Parameters {
public:
  /// @throws Error if a define has no name, too long a name, or comes twice.
  explicit Parameters(const std::vector<std::pair<std::string, std::string>>& defines);

  /// A <default>: counts only if the name is not taken yet.
  void add_default(std::string_view name, std::string_view value, const SourcePosition& where);

  /// Replaces `$name` (the longest known name counts) and `\$` by a dollar. What is put in is
  /// itself expanded. @throws Error for an unknown name or runaway growth.
  std::string expand(std::string_view text, const SourcePosition& where);

  /// @throws Error (or warns) if a define was never used.
  void check_unused(bool permissive, const Warn& warn) const;

private:
  struct Parameter {
    std::string value;
    bool is_define = false;
    bool used = false;
  };
  using Map = std::map<std::string, Parameter, std::less<>>;

  Map::iterator longest_match(std::string_view text);
  void expand_into(std::string& out, std::string_view text, const SourcePosition& where, int depth);

  Map parameters_;
  size_t inserted_ = 0; // bytes put in so far, over the whole scene
};

} // namespace faceta::xml
