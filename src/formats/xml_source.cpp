#include "formats/xml_source.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <system_error>

namespace faceta::xml {

namespace {

constexpr size_t kMaxMarks = 32'000'000;

void append_utf8(std::string& out, uint32_t code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xC0 | (code >> 6));
    out += static_cast<char>(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    out += static_cast<char>(0xE0 | (code >> 12));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    out += static_cast<char>(0xF0 | (code >> 18));
    out += static_cast<char>(0x80 | ((code >> 12) & 0x3F));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (code & 0x3F));
  }
}

std::string utf16_to_utf8(std::string_view bytes, bool big_endian, const std::string& name) {
  if (bytes.size() % 2 != 0)
    throw Error("UTF-16 text ends in the middle of a character", {name});
  auto unit = [&](size_t i) {
    auto a = static_cast<uint8_t>(bytes[i]), b = static_cast<uint8_t>(bytes[i + 1]);
    return static_cast<uint32_t>(big_endian ? a << 8 | b : b << 8 | a);
  };
  std::string out;
  out.reserve(bytes.size() / 2);
  for (size_t i = 0; i < bytes.size(); i += 2) {
    uint32_t code = unit(i);
    if (code >= 0xD800 && code < 0xE000) {
      bool paired =
          code < 0xDC00 && i + 3 < bytes.size() && unit(i + 2) >= 0xDC00 && unit(i + 2) < 0xE000;
      if (!paired)
        throw Error("UTF-16 text has half a surrogate pair", {name});
      code = 0x10000 + ((code - 0xD800) << 10) + (unit(i + 2) - 0xDC00);
      i += 2;
    }
    append_utf8(out, code);
  }
  return out;
}

std::string latin1_to_utf8(std::string_view bytes) {
  std::string out;
  out.reserve(bytes.size());
  for (char c : bytes)
    append_utf8(out, static_cast<uint8_t>(c));
  return out;
}

/// Encoding named by the XML declaration, lower case; empty if there is none.
std::string declared_encoding(std::string_view text) {
  if (!text.starts_with("<?xml"))
    return {};
  std::string_view head = text.substr(0, std::min(text.find("?>"), size_t{256}));
  size_t at = head.find("encoding");
  if (at == head.npos)
    return {};
  size_t open = head.find_first_of("\"'", at);
  size_t close = open == head.npos ? open : head.find(head[open], open + 1);
  if (close == head.npos)
    return {};
  std::string name(head.substr(open + 1, close - open - 1));
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return c < 128 ? std::tolower(c) : c; });
  return name;
}

std::string to_utf8(std::string text, const std::string& name) {
  std::string_view bytes = text;
  using namespace std::string_view_literals;
  if (bytes.starts_with("\xEF\xBB\xBF"sv))
    return text.substr(3);
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv))
    throw Error("the file is UTF-32", {name}, "save it as UTF-8");
  if (bytes.starts_with("\xFF\xFE"sv))
    return utf16_to_utf8(bytes.substr(2), false, name);
  if (bytes.starts_with("\xFE\xFF"sv))
    return utf16_to_utf8(bytes.substr(2), true, name);
  if (bytes.starts_with("<\0"sv))
    return utf16_to_utf8(bytes, false, name);
  if (bytes.starts_with("\0<"sv))
    return utf16_to_utf8(bytes, true, name);
  std::string encoding = declared_encoding(bytes);
  if (encoding == "iso-8859-1" || encoding == "latin1")
    return latin1_to_utf8(bytes);
  return text;
}

const char* plain_message(pugi::xml_parse_status status) {
  switch (status) {
  case pugi::status_unrecognized_tag:
    return "not a tag: after '<' a name, '/', '!' or '?' must follow";
  case pugi::status_bad_pi:
    return "malformed <?...?> declaration";
  case pugi::status_bad_comment:
    return "comment without an end ('-->' is missing)";
  case pugi::status_bad_cdata:
    return "CDATA section without an end (']]>' is missing)";
  case pugi::status_bad_doctype:
    return "malformed <!DOCTYPE ...>";
  case pugi::status_bad_pcdata:
    return "malformed text";
  case pugi::status_bad_start_element:
    return "malformed start tag";
  case pugi::status_bad_attribute:
    return "malformed attribute: write name=\"value\"";
  case pugi::status_bad_end_element:
    return "malformed end tag";
  case pugi::status_end_element_mismatch:
    return "an element is not closed by its own end tag";
  case pugi::status_no_document_element:
    return "no XML element found";
  case pugi::status_out_of_memory:
    return "out of memory";
  default:
    return "not well-formed XML";
  }
}

} // namespace

Source::Source(std::string name, std::string text) : name_(std::move(name)) {
  text_ = to_utf8(std::move(text), name_);
  index_lines();
  if (size_t zero = text_.find('\0'); zero != text_.npos) {
    SourcePosition where = position(zero);
    throw Error("zero byte in the file: it is binary, not XML", where);
  }
  parse();
}

void Source::index_lines() {
  if (text_.size() > UINT32_MAX)
    throw Error("the text is larger than 4 GB", {name_});
  line_starts_.push_back(0);
  size_t marks = 0;
  for (size_t i = 0; i < text_.size(); ++i) {
    auto c = static_cast<uint8_t>(text_[i]);
    marks += c == '<' || c == '=';
    bool lone_return = c == '\r' && !(i + 1 < text_.size() && text_[i + 1] == '\n');
    if (c == '\n' || lone_return)
      line_starts_.push_back(static_cast<uint32_t>(i + 1));
    else if ((c & 0xC0) == 0x80)
      wide_.push_back(static_cast<uint32_t>(i));
  }
  // bounds what the parsed document takes, which is many times what stands in the file
  if (marks > kMaxMarks)
    throw Error(fmt::format("the file has more than {} tags and attributes", kMaxMarks), {name_});
}

void Source::parse() {
  size_t size = text_.size();
  // the terminator goes along: pugixml would put one over the last character
  pugi::xml_parse_result result = document_.load_buffer_inplace(
      text_.data(), size + 1, pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    size_t offset = result.offset < 0 ? 0 : std::min<size_t>(result.offset, size);
    throw Error(plain_message(result.status), position(offset));
  }
  pugi::xml_node first = root();
  for (pugi::xml_node node = first.next_sibling(); node; node = node.next_sibling())
    if (node.type() == pugi::node_element)
      throw Error(fmt::format("second root element <{}>", node.name()), position(node),
                  "a file has one root; put both into a <scene>");
}

SourcePosition Source::position(size_t offset) const {
  auto line = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset) - 1;
  auto first = std::lower_bound(wide_.begin(), wide_.end(), *line);
  auto last = std::lower_bound(first, wide_.end(), offset);
  return {name_, static_cast<int>(line - line_starts_.begin()) + 1,
          static_cast<int>(offset - *line - (last - first)) + 1};
}

SourcePosition Source::position(pugi::xml_node node) const {
  ptrdiff_t offset = node.offset_debug();
  return offset < 1 ? SourcePosition{name_} : position(static_cast<size_t>(offset - 1));
}

SourcePosition Source::position(const char* text, pugi::xml_node node) const {
  auto address = reinterpret_cast<uintptr_t>(text);
  auto begin = reinterpret_cast<uintptr_t>(text_.data());
  if (address < begin || address >= begin + text_.size())
    return position(node);
  return position(static_cast<size_t>(address - begin));
}

std::string read_text_file(const std::filesystem::path& path, size_t limit,
                           const SourcePosition& where) {
  std::error_code code;
  auto status = std::filesystem::status(path, code);
  if (status.type() == std::filesystem::file_type::not_found)
    throw Error(fmt::format("file '{}' does not exist", path.string()), where);
  if (code)
    throw Error(fmt::format("cannot read '{}': {}", path.string(), code.message()), where);
  if (std::filesystem::is_directory(status))
    throw Error(fmt::format("'{}' is a folder, not a file", path.string()), where);
  if (!std::filesystem::is_regular_file(status))
    throw Error(fmt::format("'{}' is not a regular file", path.string()), where);
  uintmax_t size = std::filesystem::file_size(path, code);
  if (code)
    throw Error(fmt::format("cannot read '{}': {}", path.string(), code.message()), where);
  if (size > limit)
    throw Error(fmt::format("'{}' has {} bytes, the most for this kind of file is {}",
                            path.string(), size, limit),
                where);
  std::ifstream file(path, std::ios::binary);
  std::string text(static_cast<size_t>(size), '\0');
  if (!file)
    throw Error(fmt::format("cannot open '{}': {}", path.string(), std::strerror(errno)), where);
  file.read(text.data(), static_cast<std::streamsize>(size));
  text.resize(static_cast<size_t>(std::max<std::streamsize>(0, file.gcount())));
  if (text.size() != size)
    throw Error(fmt::format("cannot read all of '{}'", path.string()), where);
  return text;
}

} // namespace faceta::xml
