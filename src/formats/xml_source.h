#pragma once

#include "base/error.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace faceta::xml {

/// One XML text with its parsed document and the means to say where something stands in it.
class Source {
public:
  /// Takes UTF-8 (with or without byte order mark), UTF-16 or declared ISO-8859-1.
  /// @throws Error with line and column if it is not well-formed.
  Source(std::string name, std::string text);
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  const std::string& name() const { return name_; }
  pugi::xml_node root() const { return document_.document_element(); }

  /// The '<' of an element.
  SourcePosition position(pugi::xml_node node) const;
  /// The first character of a name or value that the document holds; else that of `node`.
  SourcePosition position(const char* text, pugi::xml_node node) const;
  /// A byte of the text. Columns count characters. Quick for increasing offsets.
  SourcePosition position(size_t offset) const;

private:
  void index_lines();
  void parse();

  std::string name_;
  std::string text_; // pugixml works in place: only starts of tokens stay what they were
  std::vector<uint32_t> line_starts_;
  std::vector<uint32_t> wide_; // offsets of UTF-8 continuation bytes
  pugi::xml_document document_;
};

/// A whole regular file. @throws Error if it is missing, a folder, unreadable or above `limit`.
std::string read_text_file(const std::filesystem::path& path, size_t limit,
                           const SourcePosition& where = {});

} // namespace faceta::xml
