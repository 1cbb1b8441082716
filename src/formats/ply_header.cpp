#include "formats/ply_header.h"

#include <charconv>
#include <optional>
#include <unordered_set>

namespace faceta {

namespace {

struct TypeName {
  const char* name;
  PlyType type;
};

constexpr TypeName kTypeNames[] = {
    {"char", PlyType::kI8},    {"uchar", PlyType::kU8},    {"short", PlyType::kI16},
    {"ushort", PlyType::kU16}, {"int", PlyType::kI32},     {"uint", PlyType::kU32},
    {"float", PlyType::kF32},  {"double", PlyType::kF64},  {"int8", PlyType::kI8},
    {"uint8", PlyType::kU8},   {"int16", PlyType::kI16},   {"uint16", PlyType::kU16},
    {"int32", PlyType::kI32},  {"uint32", PlyType::kU32},  {"int64", PlyType::kI64},
    {"uint64", PlyType::kU64}, {"long", PlyType::kI64},    {"ulong", PlyType::kU64},
    {"half", PlyType::kF16},   {"float16", PlyType::kF16}, {"float32", PlyType::kF32},
    {"float64", PlyType::kF64}};

class HeaderParser {
public:
  explicit HeaderParser(const InputText& source)
      : source_(source), p_(source.text.data()), end_(p_ + source.text.size()) {}

  PlyHeader run() {
    if (!next_line() || next_word() != "ply")
      throw Error("not a PLY file", {source_.name, 1, 1}, "its first line must be 'ply'");
    finish_line();
    while (true) {
      if (!next_line())
        throw source_.error(end_, "the PLY header has no end_header");
      std::string_view word = next_word();
      if (word.empty() || word == "comment" || word == "obj_info")
        continue;
      if (word == "end_header")
        break;
      statement(word);
    }
    finish_line();
    if (!has_format_)
      throw source_.error(word_start_, "the PLY header has no format line");
    header_.data_offset = static_cast<size_t>(next_ - source_.text.data());
    check_counts();
    return std::move(header_);
  }

private:
  // Moves to the next line of the header; false at the end of the file.
  bool next_line() {
    if (next_)
      p_ = next_;
    if (p_ == end_)
      return false;
    line_end_ = p_;
    while (line_end_ != end_ && *line_end_ != '\n' && *line_end_ != '\r')
      ++line_end_;
    next_ = line_end_;
    if (next_ != end_ && *next_ == '\r')
      ++next_;
    if (next_ != end_ && *next_ == '\n' && (next_ == line_end_ || next_[-1] == '\r'))
      ++next_;
    return true;
  }

  std::string_view next_word() {
    while (p_ != line_end_ && (*p_ == ' ' || *p_ == '\t'))
      ++p_;
    word_start_ = p_;
    while (p_ != line_end_ && *p_ != ' ' && *p_ != '\t')
      ++p_;
    return {word_start_, static_cast<size_t>(p_ - word_start_)};
  }

  std::string_view need_word(const char* what) {
    std::string_view word = next_word();
    if (word.empty())
      throw source_.error(word_start_, std::string("the PLY header lacks ") + what);
    return word;
  }

  Error unexpected(const char* what, const std::string& hint = {}) const {
    return source_.error(
        word_start_, std::string("unknown ") + what + " '" + word_at(word_start_, line_end_) + "'",
        hint);
  }

  void finish_line() {
    if (!next_word().empty())
      throw source_.error(word_start_, "unexpected '" + word_at(word_start_, line_end_) +
                                           "' at the end of a PLY header line");
  }

  void statement(std::string_view word) {
    if (word == "format")
      format();
    else if (word == "element")
      element();
    else if (word == "property")
      property();
    else
      throw unexpected("PLY header statement",
                       "known: format, element, property, comment, obj_info, end_header");
    finish_line();
  }

  void format() {
    if (has_format_)
      throw source_.error(word_start_, "the PLY header has two format lines");
    has_format_ = true;
    std::string_view word = need_word("a format name");
    if (word == "ascii")
      header_.encoding = PlyEncoding::kAscii;
    else if (word == "binary_little_endian")
      header_.encoding = PlyEncoding::kLittleEndian;
    else if (word == "binary_big_endian")
      header_.encoding = PlyEncoding::kBigEndian;
    else
      throw unexpected("PLY format", "known: ascii, binary_little_endian, binary_big_endian");
    if (need_word("a format version") != "1.0")
      throw unexpected("PLY version", "known: 1.0");
  }

  void element() {
    std::string name(need_word("the name of an element"));
    if (!element_names_.insert(name).second)
      throw source_.error(word_start_,
                          "element '" + word_at(word_start_, line_end_) + "' is declared twice");
    std::string_view word = need_word("the count of an element");
    uint64_t count = 0;
    auto result = std::from_chars(word.data(), word.data() + word.size(), count);
    if (result.ec != std::errc() || result.ptr != word.data() + word.size())
      throw source_.error(word_start_,
                          "'" + word_at(word_start_, line_end_) + "' is not a count of elements");
    header_.elements.push_back({name, count, {}});
    count_at_.push_back(word_start_);
    property_names_.clear();
  }

  PlyType type() {
    std::string_view word = need_word("a property type");
    for (const TypeName& known : kTypeNames)
      if (word == known.name)
        return known.type;
    throw unexpected("PLY type", "known: char, uchar, short, ushort, int, uint, float, double");
  }

  void property() {
    if (header_.elements.empty())
      throw source_.error(word_start_, "a property before the first element");
    PlyProperty property;
    const char* before = p_;
    property.is_list = next_word() == "list";
    if (property.is_list) {
      property.count_type = type();
      if (!is_integer(property.count_type))
        throw source_.error(word_start_, "the count of a list cannot be a fraction");
    } else {
      p_ = before;
    }
    property.type = type();
    property.name = need_word("the name of a property");
    if (!property_names_.insert(property.name).second)
      throw source_.error(word_start_,
                          "property '" + word_at(word_start_, line_end_) + "' is declared twice");
    header_.elements.back().properties.push_back(property);
  }

  // Every row has a least size: counts that the file cannot hold are refused before any allocation.
  void check_counts() const {
    uint64_t left = source_.text.size() - header_.data_offset;
    for (size_t i = 0; i < header_.elements.size(); ++i) {
      const PlyElement& element = header_.elements[i];
      uint64_t row = 0;
      for (const PlyProperty& property : element.properties)
        row += header_.encoding == PlyEncoding::kAscii ? 2
               : property.is_list                      ? size_of(property.count_type)
                                                       : size_of(property.type);
      // The last number of a text file needs no separator behind it.
      uint64_t room = header_.encoding == PlyEncoding::kAscii ? left + 1 : left;
      if (row != 0 && element.count > room / row)
        throw source_.error(count_at_[i], "element '" +
                                              word_at(element.name.data(),
                                                      element.name.data() + element.name.size()) +
                                              "' claims more rows than the file can hold");
    }
  }

  const InputText& source_;
  const char* p_;
  const char* end_;
  const char* line_end_ = nullptr;
  const char* next_ = nullptr;
  const char* word_start_ = nullptr;
  bool has_format_ = false;
  PlyHeader header_;
  std::vector<const char*> count_at_;
  std::unordered_set<std::string> element_names_, property_names_;
};

} // namespace

size_t size_of(PlyType type) {
  switch (type) {
  case PlyType::kI8:
  case PlyType::kU8:
    return 1;
  case PlyType::kI16:
  case PlyType::kU16:
  case PlyType::kF16:
    return 2;
  case PlyType::kI32:
  case PlyType::kU32:
  case PlyType::kF32:
    return 4;
  default:
    return 8;
  }
}

bool is_integer(PlyType type) {
  return type != PlyType::kF16 && type != PlyType::kF32 && type != PlyType::kF64;
}

PlyHeader parse_ply_header(const InputText& source) {
  return HeaderParser(source).run();
}

} // namespace faceta
