#include "formats/csv.h"

#include "base/error.h"
#include "base/happens_before.h"
#include "formats/output_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <memory>
#include <string_view>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <unistd.h>
#include <unordered_set>

namespace faceta {

namespace {

constexpr size_t kBlockBytes = size_t(1) << 17;
constexpr size_t kMaxLineBytes = size_t(1) << 20;
constexpr size_t kMaxNumberBytes = 16;

/// Whole lines of a table, each with its end.
struct Block {
  std::string text;
  int first_line = 0;
};

/// Cuts a file, or the standard input, into blocks of whole lines.
class BlockReader {
public:
  explicit BlockReader(const std::string& source) : name_(source == "-" ? "<stdin>" : source) {
    descriptor_ = source == "-" ? STDIN_FILENO : ::open(source.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0)
      throw Error(std::string("cannot read: ") + std::strerror(errno), {name_});
  }
  ~BlockReader() {
    if (descriptor_ != STDIN_FILENO)
      ::close(descriptor_);
  }
  BlockReader(const BlockReader&) = delete;
  BlockReader& operator=(const BlockReader&) = delete;

  const std::string& name() const { return name_; }

  /// The first line alone; nothing if there is none.
  std::optional<Block> header() {
    while (rest_.find('\n') == std::string::npos && fill(kBlockBytes))
      check_line_length();
    return cut(rest_.find('\n'));
  }
  /// The next block; nothing at the end.
  std::optional<Block> next() {
    while (fill(kBlockBytes) && (rest_.size() < kBlockBytes || !has_line_end()))
      check_line_length();
    return cut(rest_.rfind('\n'));
  }

private:
  bool has_line_end() const { return rest_.find('\n') != std::string::npos; }
  void check_line_length() const {
    if (rest_.size() > kMaxLineBytes && !has_line_end())
      throw Error("a line is longer than 1 MiB", {name_, line_, 1}, "is this a CSV file?");
  }
  /// Appends what one read gives until `rest_` has `size` bytes; false at the end of the file.
  bool fill(size_t size) {
    if (ended_)
      return false;
    size_t old = rest_.size();
    size_t wanted = std::max(size, old + 4096);
    rest_.resize(wanted);
    ssize_t got;
    do
      got = ::read(descriptor_, rest_.data() + old, wanted - old);
    while (got < 0 && errno == EINTR);
    rest_.resize(old + static_cast<size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0)
      throw Error(std::string("cannot read: ") + std::strerror(errno), {name_});
    ended_ = got == 0;
    return !ended_;
  }
  /// Takes everything up to this line end; everything if there is none.
  std::optional<Block> cut(size_t line_end) {
    if (rest_.empty())
      return std::nullopt;
    size_t size = line_end == std::string::npos ? rest_.size() : line_end + 1;
    Block block{rest_.substr(0, size), line_};
    rest_.erase(0, size);
    line_ += static_cast<int>(std::count(block.text.begin(), block.text.end(), '\n'));
    return block;
  }

  std::string name_, rest_;
  int descriptor_ = -1, line_ = 1;
  bool ended_ = false;
};

bool is_space(char c) {
  return c == ' ' || c == '\t';
}

/// Something wrong in a line, before the line is known.
struct Malformed {
  size_t offset;
  std::string message, hint;
};

/// The fields of one line, left to right.
class FieldCursor {
public:
  explicit FieldCursor(std::string_view line) : line_(line) {}

  bool at_end() const { return next_ > line_.size(); }
  /// Offset of the text that the last call read.
  size_t offset() const { return offset_; }

  /// The next field without the spaces and quotes around it.
  std::string_view text() {
    skip_spaces();
    if (next_ < line_.size() && line_[next_] == '"')
      return quoted();
    size_t end = std::min(line_.find(',', next_), line_.size());
    size_t last = end;
    while (last > next_ && is_space(line_[last - 1]))
      --last;
    std::string_view field = line_.substr(next_, last - next_);
    next_ = end + 1;
    return field;
  }

  /// The next field as a finite number.
  float number(const std::string& column) {
    size_t begin = next_;
    skip_spaces();
    float value;
    const char* end = line_.data() + line_.size();
    auto [stop, error] = std::from_chars(line_.data() + next_, end, value);
    if (error == std::errc() && (stop == end || *stop == ',') && std::isfinite(value)) {
      next_ = static_cast<size_t>(stop - line_.data()) + 1;
      return value;
    }
    next_ = begin;
    return unusual_number(text(), column);
  }

private:
  void skip_spaces() {
    while (next_ < line_.size() && is_space(line_[next_]))
      ++next_;
    offset_ = next_;
  }
  std::string_view quoted() {
    size_t begin = next_ + 1, end = begin;
    while (end < line_.size() && (line_[end] != '"' || line_.substr(end, 2) == "\"\""))
      end += line_[end] == '"' ? 2 : 1;
    if (end >= line_.size())
      throw Malformed{offset_, "a quoted field has no end", "a field ends on its line"};
    next_ = end + 1;
    while (next_ < line_.size() && is_space(line_[next_]))
      ++next_;
    if (next_ < line_.size() && line_[next_] != ',')
      throw Malformed{next_, "text after a quoted field", "a comma or the end of the line"};
    ++next_;
    return line_.substr(begin, end - begin);
  }
  /// A plus sign, a trailing space, quotes, exponents beyond a float's range.
  float unusual_number(std::string_view field, const std::string& column) const {
    std::string_view text = field;
    if (text.substr(0, 1) == "+" && text.substr(1, 1) != "-")
      text.remove_prefix(1);
    double value = 0;
    auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range && is_tiny(text))
      value = 0;
    else if (error != std::errc())
      value = std::numeric_limits<double>::infinity();
    if (stop != text.data() + text.size() || !std::isfinite(static_cast<float>(value)))
      throw Malformed{offset_, "column '" + column + "': " + shown(field) + " is no finite number",
                      ""};
    return static_cast<float>(value);
  }
  /// Of a number outside the range of a double: whether it is too small rather than too large.
  static bool is_tiny(std::string_view text) {
    size_t exponent = text.find_first_of("eE");
    if (exponent != std::string_view::npos)
      return text.substr(exponent + 1, 1) == "-";
    size_t digit = text.find_first_not_of("-0");
    return digit != std::string_view::npos && text[digit] == '.';
  }
  static std::string shown(std::string_view field) {
    if (field.empty())
      return "an empty field";
    std::string text;
    for (char c : field.substr(0, 40))
      text += c >= ' ' && c != 127 ? c : '?';
    return "'" + text + (field.size() > 40 ? "...'" : "'");
  }

  std::string_view line_;
  size_t next_ = 0, offset_ = 0;
};

/// The next line of a block, without its end.
std::string_view take_line(std::string_view& text) {
  size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (!line.empty() && line.back() == '\r')
    line.remove_suffix(1);
  return line;
}

bool is_blank(std::string_view line) {
  return std::all_of(line.begin(), line.end(), is_space);
}

/// What the header says.
struct Layout {
  std::string header;
  std::vector<std::string> names;
  std::vector<int> input_of_column; ///< -1: not needed
};

[[noreturn]] void raise(const std::string& file, int line, Malformed what) {
  throw Error(std::move(what.message), {file, line, static_cast<int>(what.offset) + 1},
              std::move(what.hint));
}

/// Names of the columns that the table must have.
std::vector<std::string> needed_columns(const std::vector<CsvInput>& inputs) {
  std::vector<std::string> names;
  for (const CsvInput& input : inputs)
    if (!input.missing)
      names.push_back(input.name);
  return names;
}

void check_complete(const std::vector<std::string>& names, const std::vector<CsvInput>& inputs) {
  std::string all;
  for (const std::string& name : needed_columns(inputs))
    all += (all.empty() ? "" : ",") + name;
  for (const std::string& name : needed_columns(inputs))
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Malformed{0, "there is no column '" + name + "'",
                      "the first line names the columns: " + all};
}

Layout read_header(const Block& block, const std::string& file, const std::vector<CsvInput>& inputs,
                   const std::vector<CsvOutput>& outputs) try {
  std::string_view text = block.text;
  if (text.substr(0, 3) == "\xEF\xBB\xBF")
    text.remove_prefix(3);
  Layout layout;
  layout.header = take_line(text);
  for (FieldCursor cursor(layout.header); !cursor.at_end();)
    layout.names.emplace_back(cursor.text());
  // A file without a header lacks its columns, before anything else is wrong with it.
  check_complete(layout.names, inputs);
  FieldCursor cursor(layout.header);
  std::unordered_set<std::string_view> before; // a header may hold 10^6 names
  for (const std::string& name : layout.names) {
    cursor.text();
    if (!before.insert(name).second)
      throw Malformed{cursor.offset(), "column '" + name + "' is there twice", ""};
    for (const CsvOutput& output : outputs)
      if (name == output.name)
        throw Malformed{cursor.offset(), "column '" + name + "' is there already",
                        "it is one of the results: rename or remove it"};
    auto input = std::find_if(inputs.begin(), inputs.end(),
                              [&](const CsvInput& i) { return i.name == name; });
    layout.input_of_column.push_back(
        input == inputs.end() ? -1 : static_cast<int>(input - inputs.begin()));
  }
  return layout;
} catch (Malformed& malformed) {
  raise(file, block.first_line, std::move(malformed));
}

/// A block on its way: its rows, the lines they stand on, and the text that comes out.
struct Work {
  std::vector<std::string_view> lines;
  std::vector<int> numbers; ///< of the lines, in the file
  CsvRows rows;
  std::string text;
  std::optional<Error> error;
};

class Transform {
public:
  Transform(const std::string& file, Layout layout, const std::vector<CsvInput>& inputs,
            const std::vector<CsvOutput>& outputs, const std::function<void(CsvRows&)>& function)
      : file_(file), layout_(std::move(layout)), inputs_(inputs), outputs_(outputs),
        function_(function) {}

  /// Never throws for what the block holds: the first bad block in the order of the file counts.
  std::shared_ptr<Work> run(const Block& block) const {
    auto work = std::make_shared<Work>();
    try {
      read(block, *work);
      // Rows before a malformed one are complained of first.
      function_(work->rows);
      if (work->rows.complaint)
        raise_complaint(*work);
      if (!work->error)
        write(*work, block.text.size());
    } catch (Error& error) {
      work->error = error;
    }
    return work;
  }

private:
  void read(const Block& block, Work& work) const {
    size_t rows = static_cast<size_t>(std::count(block.text.begin(), block.text.end(), '\n')) + 1;
    work.lines.reserve(rows);
    work.numbers.reserve(rows);
    work.rows.input.resize(inputs_.size());
    for (size_t i = 0; i < inputs_.size(); ++i)
      work.rows.input[i].assign(rows, inputs_[i].missing.value_or(0));
    int number = block.first_line;
    for (std::string_view text = block.text; !text.empty(); ++number) {
      std::string_view line = take_line(text);
      if (is_blank(line))
        continue;
      try {
        read_row(line, work.lines.size(), work.rows);
      } catch (const Malformed& malformed) {
        work.error = Error(malformed.message,
                           {file_, number, static_cast<int>(malformed.offset) + 1}, malformed.hint);
        break;
      }
      work.lines.push_back(line);
      work.numbers.push_back(number);
    }
    work.rows.count = static_cast<int>(work.lines.size());
    for (std::vector<float>& column : work.rows.input)
      column.resize(work.lines.size());
    work.rows.output.assign(outputs_.size(), std::vector<float>(work.lines.size(), 0.0f));
  }

  void read_row(std::string_view line, size_t row, CsvRows& rows) const {
    FieldCursor cursor(line);
    for (size_t column = 0; column < layout_.names.size(); ++column) {
      if (cursor.at_end())
        throw Malformed{line.size(),
                        "the line has " + std::to_string(column) + " fields, its header " +
                            std::to_string(layout_.names.size()),
                        "missing: " + layout_.names[column]};
      int input = layout_.input_of_column[column];
      if (input < 0)
        cursor.text();
      else
        rows.input[static_cast<size_t>(input)][row] = cursor.number(layout_.names[column]);
    }
    if (!cursor.at_end()) {
      cursor.text();
      throw Malformed{cursor.offset(),
                      "the line has more fields than its header, which has " +
                          std::to_string(layout_.names.size()),
                      ""};
    }
  }

  [[noreturn]] void raise_complaint(const Work& work) const {
    const CsvRows::Complaint& complaint = *work.rows.complaint;
    size_t row = static_cast<size_t>(complaint.row), offset = 0;
    FieldCursor cursor(work.lines[row]);
    for (int input : layout_.input_of_column) {
      cursor.text();
      if (input == complaint.input) {
        offset = cursor.offset();
        break;
      }
    }
    raise(file_, work.numbers[row], {offset, complaint.message, complaint.hint});
  }

  void write(Work& work, size_t input_bytes) const {
    size_t row_bytes = 2;
    for (const CsvOutput& output : outputs_) {
      size_t widest = kMaxNumberBytes;
      for (const std::string& word : output.words)
        widest = std::max(widest, word.size());
      row_bytes += widest + 1;
    }
    work.text.resize(input_bytes + work.lines.size() * row_bytes);
    char* out = work.text.data();
    for (size_t row = 0; row < work.lines.size(); ++row) {
      out = std::copy(work.lines[row].begin(), work.lines[row].end(), out);
      for (size_t i = 0; i < outputs_.size(); ++i) {
        *out++ = ',';
        float value = work.rows.output[i][row];
        const std::vector<std::string>& words = outputs_[i].words;
        if (words.empty()) {
          out = std::to_chars(out, out + kMaxNumberBytes, value).ptr;
        } else {
          const std::string& word = words[static_cast<size_t>(value)];
          out = std::copy(word.begin(), word.end(), out);
        }
      }
      *out++ = '\n';
    }
    work.text.resize(static_cast<size_t>(out - work.text.data()));
  }

  std::string file_;
  Layout layout_;
  const std::vector<CsvInput>& inputs_;
  const std::vector<CsvOutput>& outputs_;
  const std::function<void(CsvRows&)>& function_;
};

/// Every block from the reader through the transformation to `write`, in the order of the file.
void run_blocks(BlockReader& reader, const Transform& transform,
                const std::function<void(const std::string&)>& write) {
  using BlockPointer = std::shared_ptr<Block>;
  using WorkPointer = std::shared_ptr<Work>;
  // Errors wait until the pipeline is empty: TBB loses the blocks that are on their way when an
  // exception ends it. What is wrong further up in the file counts, so a row before the reading.
  std::optional<Error> reading, row;
  std::atomic<bool> stopped = false;
  tbb::filter<void, BlockPointer> read(tbb::filter_mode::serial_in_order,
                                       [&](tbb::flow_control& control) {
                                         std::optional<Block> block;
                                         try {
                                           if (!stopped)
                                             block = reader.next();
                                         } catch (const Error& error) {
                                           reading = error;
                                         }
                                         happens_before::publish(&reader);
                                         if (!block) {
                                           control.stop();
                                           return BlockPointer();
                                         }
                                         return std::make_shared<Block>(std::move(*block));
                                       });
  // The lines of a work point into its block, which lives until the text is made.
  tbb::filter<BlockPointer, WorkPointer> run(tbb::filter_mode::parallel,
                                             [&](const BlockPointer& block) {
                                               WorkPointer work = transform.run(*block);
                                               happens_before::publish(&reader);
                                               return work;
                                             });
  tbb::filter<WorkPointer, void> append(tbb::filter_mode::serial_in_order,
                                        [&](const WorkPointer& work) {
                                          try {
                                            if (work->error)
                                              throw Error(*work->error);
                                            if (!stopped)
                                              write(work->text);
                                          } catch (const Error& error) {
                                            row = row ? row : error;
                                            stopped = true;
                                          }
                                          happens_before::publish(&reader);
                                        });
  size_t tokens = 2 * static_cast<size_t>(tbb::this_task_arena::max_concurrency()) + 2;
  tbb::parallel_pipeline(tokens, read & run & append);
  happens_before::receive(&reader);
  if (row || reading)
    throw row ? *row : *reading;
}

} // namespace

void transform_csv(const std::string& source, const std::string& target,
                   const std::vector<CsvInput>& inputs, const std::vector<CsvOutput>& outputs,
                   const std::function<void(CsvRows&)>& function) {
  BlockReader reader(source);
  std::optional<Block> first = reader.header();
  if (!first)
    throw Error("the table is empty", {reader.name()}, "its first line names the columns");
  Layout layout = read_header(*first, reader.name(), inputs, outputs);
  std::string header = layout.header;
  for (const CsvOutput& output : outputs)
    header += "," + output.name;
  const Transform transform(reader.name(), std::move(layout), inputs, outputs, function);
  OutputFile file(target);
  bool header_written = false;
  auto write = [&](const std::string& text) {
    if (!header_written)
      file.write(header + "\n");
    header_written = true;
    file.write(text);
  };

  run_blocks(reader, transform, write);
  if (!header_written)
    write("");
  file.commit();
}

} // namespace faceta
