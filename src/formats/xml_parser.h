#pragma once

#include "formats/xml_parameters.h"
#include "formats/xml_source.h"
#include "formats/xml_tree.h"

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace faceta::xml {

/// One scene file while it is read.
struct FileState {
  const Source* source = nullptr;
  bool upgrade = false; // written for a version before 2.0.0
  FileState* parent = nullptr;
  /// <path>s (latest first) and the file's own folder.
  std::vector<std::filesystem::path> own_folders;
  /// What its nodes search; filled in when everything has been read.
  std::shared_ptr<std::vector<std::filesystem::path>> folders;
};

/// An element with its attributes after substitution.
struct Element {
  pugi::xml_node node;
  std::string tag;
  SourcePosition where;
  struct Attribute {
    std::string name, value;
    SourcePosition name_where, value_where;
  };
  std::vector<Attribute> attributes;

  const Attribute* find(std::string_view name) const;
  /// The attribute's value; it must be there (see Parser::check_attributes).
  const std::string& value(std::string_view name) const { return find(name)->value; }
  const SourcePosition& value_where(std::string_view name) const { return find(name)->value_where; }
  std::string name() const;
};

/// An object whose children are being read.
struct Frame {
  NodePtr node;
  FileState* file = nullptr;
  int depth = 0;
  bool is_root = false;
  size_t next_argument = 0;
  std::unordered_set<std::string> names;
};

class Parser {
public:
  explicit Parser(const ParseOptions& options);
  ~Parser();

  NodePtr parse_file(const std::filesystem::path& path);
  NodePtr parse_string(std::string_view text, const std::string& name);

private:
  NodePtr finish(NodePtr root);
  FileState& open(std::string name, std::string text, FileState* parent);
  NodePtr read_root(FileState& file, int depth);
  void check_version(FileState& file, const Element& element);

  Element read_element(FileState& file, pugi::xml_node node);
  void check_attributes(const Element& element, std::initializer_list<std::string_view> required,
                        std::initializer_list<std::string_view> optional);
  void check_childless(const Element& element, FileState& file);
  NodePtr read_object(FileState& file, const Element& element, int depth, bool is_root,
                      bool is_included);
  void read_children(Frame& frame, pugi::xml_node node);
  void read_child(Frame& frame, const Element& element);
  bool read_value(Frame& frame, const Element& element);
  bool read_directive(Frame& frame, const Element& element);
  void read_point(Frame& frame, const Element& element, Type type);
  void read_rgb(Frame& frame, const Element& element);
  void read_spectrum(Frame& frame, const Element& element);
  void read_transform(Frame& frame, const Element& element);
  void read_include(Frame& frame, const Element& element);
  void read_path(Frame& frame, const Element& element);
  void read_alias(const Element& element);
  void splice(Frame& frame, Node& scene);
  void add(Frame& frame, std::string name, Type type, Value value, const SourcePosition& where);
  void add_object(Frame& frame, std::string name, Value value, const SourcePosition& where);
  void register_id(const NodePtr& node);
  void upgrade_names(Frame& frame);
  void upgrade_texture_placement(Node& node);
  void warn_about_text(FileState& file, pugi::xml_node node);
  void warn_at(const SourcePosition& where, const std::string& message) const;
  void set_search_folders();

  std::filesystem::path resolve(const FileState& file, const std::string& name,
                                const SourcePosition& where) const;

  void resolve_references();
  void check_cycles() const;

  const ParseOptions& options_;
  Parameters parameters_;
  std::vector<std::unique_ptr<FileState>> files_;
  std::vector<std::unique_ptr<Source>> sources_; // open ones; closed when their file has been read
  std::vector<std::filesystem::path> open_files_;
  std::vector<NodePtr> nodes_;
  std::unordered_map<std::string, NodePtr> ids_;
  size_t bytes_ = 0, properties_ = 0, includes_ = 0;
  bool done_ = false;
};

/// Result of a transform operation (<translate>, <rotate>, ...). `element` is already substituted
/// and its attribute names are checked by the caller.
Matrix4 read_transform_operation(const Element& element, const Warn& warn);

/// The three numbers of `value`, or of `x`, `y`, `z` (missing: `fallback`).
Numbers3 read_three(const Element& element, double fallback);

/// camelCase to snake_case as Mitsuba upgrades names of version 1.
std::string snake_case(std::string_view name);

/// The first of `folders` (then the working folder) that has `name`.
/// @throws Error that lists them.
std::filesystem::path find_file(const std::string& name,
                                const std::vector<std::filesystem::path>& folders,
                                const SourcePosition& where);

} // namespace faceta::xml
