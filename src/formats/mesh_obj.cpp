#include "formats/mesh_obj.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace faceta {

namespace {

// Position, texture coordinate, normal: 1-based as in the file, 0 for none.
using Corner = std::array<uint32_t, 3>;

constexpr const char* kKindNames[3] = {"vertex", "texture coordinate", "normal"};

// Gives every distinct corner a number in order of first use. Open addressing: one file cannot
// make it slow by sharing a position among many corners.
class CornerTable {
public:
  uint32_t number(const Corner& corner) {
    if (2 * corners_.size() >= slots_.size())
      grow();
    uint32_t& slot = find(corner);
    if (slot == 0) {
      corners_.push_back(corner);
      slot = static_cast<uint32_t>(corners_.size());
    }
    return slot - 1;
  }
  const std::vector<Corner>& corners() const { return corners_; }

private:
  static uint64_t hash(const Corner& c) {
    uint64_t h = (uint64_t{c[0]} << 32 | c[1]) ^ (uint64_t{c[2]} * 0x9e3779b97f4a7c15u);
    h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93u;
    return h ^ (h >> 32);
  }
  uint32_t& find(const Corner& corner) {
    size_t mask = slots_.size() - 1, i = hash(corner) & mask;
    while (slots_[i] != 0 && corners_[slots_[i] - 1] != corner)
      i = (i + 1) & mask;
    return slots_[i];
  }
  void grow() {
    slots_.assign(std::max<size_t>(1024, 4 * corners_.size()), 0);
    size_t power = 1;
    while (power < slots_.size())
      power *= 2;
    slots_.resize(power, 0);
    for (size_t i = 0; i < corners_.size(); ++i)
      find(corners_[i]) = static_cast<uint32_t>(i + 1);
  }

  std::vector<Corner> corners_;
  std::vector<uint32_t> slots_;
};

class ObjParser {
public:
  ObjParser(std::string_view text, const std::string& name, const MeshOptions& options)
      : source_{text, name}, p_(text.data()), end_(text.data() + text.size()), options_(options) {}

  Mesh run() {
    if (source_.text.substr(0, 3) == "\xef\xbb\xbf")
      p_ += 3;
    while (p_ != end_) {
      statement();
      skip_line();
    }
    check_forward_references();
    if (indices_.empty())
      throw Error("the OBJ file contains no faces", {source_.name});
    return assemble();
  }

private:
  static bool is_newline(char c) { return c == '\n' || c == '\r'; }

  bool at_end_of_line() const { return p_ == end_ || is_newline(*p_) || *p_ == '#'; }

  // Blanks, and line ends behind a backslash.
  void skip_blanks() {
    for (; p_ != end_; ++p_) {
      if (*p_ == ' ' || *p_ == '\t')
        continue;
      if (*p_ == '\\' && p_ + 1 != end_ && is_newline(p_[1])) {
        p_ += (p_[1] == '\r' && p_ + 2 != end_ && p_[2] == '\n') ? 2 : 1;
        continue;
      }
      break;
    }
  }

  // Backslashes count only within v, vt, vn and f: elsewhere they may belong to a Windows path.
  void skip_line() {
    while (p_ != end_ && !is_newline(*p_))
      ++p_;
    while (p_ != end_ && is_newline(*p_))
      ++p_;
  }

  bool keyword(std::string_view word) {
    if (static_cast<size_t>(end_ - p_) <= word.size() || std::string_view(p_, word.size()) != word)
      return false;
    char next = p_[word.size()];
    if (next != ' ' && next != '\t' && next != '\\')
      return false;
    p_ += word.size();
    return true;
  }

  void statement() {
    skip_blanks();
    if (keyword("v"))
      numbers("vertex", 3, 3, positions_);
    else if (keyword("vt"))
      texture_coordinate();
    else if (keyword("vn"))
      normal();
    else if (keyword("f"))
      face();
  }

  float number(const char* what) {
    skip_blanks();
    const char* start = p_;
    float value = 0;
    NumberStatus status =
        at_end_of_line() ? NumberStatus::kMalformed : parse_float(p_, end_, value);
    bool separated = at_end_of_line() || *p_ == ' ' || *p_ == '\t' || *p_ == '\\';
    if (status == NumberStatus::kMalformed || !separated)
      throw source_.error(start, at_end_of_line() && p_ == start
                                     ? std::string("the ") + what + " has too few numbers"
                                     : "'" + word_at(start, end_) + "' is not a number");
    if (status == NumberStatus::kNotFinite)
      throw source_.error(start, std::string("the ") + what + " is not finite");
    return value;
  }

  // `needed` numbers, and zeros for what is missing up to `count`.
  void numbers(const char* what, int needed, int count, std::vector<float>& out) {
    if (out.size() / static_cast<size_t>(count) >= std::numeric_limits<uint32_t>::max() - 1)
      throw source_.error(p_, "the mesh is too large");
    for (int i = 0; i < count; ++i) {
      skip_blanks();
      out.push_back(i >= needed && at_end_of_line() ? 0.0f : number(what));
    }
  }

  void texture_coordinate() {
    numbers("texture coordinate", 1, 2, uvs_);
    if (options_.flip_tex_coords)
      uvs_.back() = 1.0f - uvs_.back();
  }

  void normal() {
    numbers("normal", 3, 3, normals_);
    float* n = &normals_[normals_.size() - 3];
    double length = std::hypot(double{n[0]}, double{n[1]}, double{n[2]});
    for (int k = 0; k < 3 && length > 0; ++k)
      n[k] = static_cast<float>(n[k] / length);
  }

  size_t count_of(int kind) const {
    return kind == 0 ? positions_.size() / 3 : kind == 1 ? uvs_.size() / 2 : normals_.size() / 3;
  }

  uint32_t index(int kind) {
    const char* start = p_;
    int64_t value = 0;
    auto result = std::from_chars(p_ + (p_ != end_ && *p_ == '+'), end_, value);
    if (result.ec == std::errc::invalid_argument)
      throw source_.error(start, "'" + word_at(start, end_) + "' is not an index");
    p_ = result.ptr;
    auto count = static_cast<int64_t>(count_of(kind));
    bool in_range = result.ec == std::errc() && value != 0 && value >= -count &&
                    value < std::numeric_limits<uint32_t>::max();
    if (!in_range)
      throw out_of_range(start, kind, std::string(start, p_), count);
    if (value < 0)
      value += count + 1;
    // Later lines may still bring it: the furthest reference is checked at the end.
    auto resolved = static_cast<uint32_t>(value);
    if (value > count && resolved > furthest_[kind]) {
      furthest_[kind] = resolved;
      furthest_at_[kind] = start;
    }
    return resolved;
  }

  Error out_of_range(const char* at, int kind, const std::string& value, int64_t count) const {
    return source_.error(at, std::string(kKindNames[kind]) + " index " + value + " is out of range",
                         count == 0 ? std::string("there are none")
                                    : "indices run from 1 to " + std::to_string(count) +
                                          ", or from -1 down");
  }

  Corner corner() {
    Corner corner = {index(0), 0, 0};
    for (int kind = 1; kind < 3 && p_ != end_ && *p_ == '/'; ++kind) {
      ++p_;
      bool present = !at_end_of_line() && *p_ != '/' && *p_ != ' ' && *p_ != '\t' && *p_ != '\\';
      corner[kind] = present ? index(kind) : 0;
    }
    if (!at_end_of_line() && *p_ != ' ' && *p_ != '\t' && *p_ != '\\')
      throw source_.error(p_, "'" + word_at(p_, end_) + "' does not belong to a face",
                          "a corner reads v, v/vt, v//vn or v/vt/vn");
    return corner;
  }

  void face() {
    Corner first{}, second{};
    uint32_t first_id = 0, previous_id = 0;
    for (size_t n = 0;; ++n) {
      skip_blanks();
      if (at_end_of_line())
        return;
      Corner next = corner();
      if (n == 0)
        first = next;
      else if (n == 1)
        second = next;
      // Corners are numbered once a third one makes a triangle of them.
      if (n == 2) {
        first_id = number_corner(first);
        previous_id = number_corner(second);
      }
      if (n >= 2) {
        uint32_t id = number_corner(next);
        indices_.insert(indices_.end(), {first_id, previous_id, id});
        previous_id = id;
      }
    }
  }

  uint32_t number_corner(const Corner& corner) {
    has_uv_ = has_uv_ || corner[1] != 0;
    has_normal_ = has_normal_ || corner[2] != 0;
    return table_.number(corner);
  }

  void check_forward_references() const {
    for (int kind = 0; kind < 3; ++kind)
      if (furthest_[kind] > count_of(kind))
        throw out_of_range(furthest_at_[kind], kind, std::to_string(furthest_[kind]),
                           static_cast<int64_t>(count_of(kind)));
  }

  static void append(std::vector<float>& out, const std::vector<float>& from, uint32_t index,
                     size_t width) {
    for (size_t k = 0; k < width; ++k)
      out.push_back(index == 0 ? 0.0f : from[width * (index - 1) + k]);
  }

  Mesh assemble() {
    Mesh mesh;
    bool keep_normals = has_normal_ && !options_.face_normals;
    const std::vector<Corner>& corners = table_.corners();
    mesh.positions.reserve(3 * corners.size());
    mesh.uvs.reserve(has_uv_ ? 2 * corners.size() : 0);
    mesh.normals.reserve(keep_normals ? 3 * corners.size() : 0);
    for (const Corner& c : corners) {
      append(mesh.positions, positions_, c[0], 3);
      if (has_uv_)
        append(mesh.uvs, uvs_, c[1], 2);
      if (keep_normals)
        append(mesh.normals, normals_, c[2], 3);
    }
    mesh.indices = std::move(indices_);
    mesh.face_normals = options_.face_normals;
    mesh.flip_normals = options_.flip_normals;
    return mesh;
  }

  InputText source_;
  const char* p_;
  const char* end_;
  MeshOptions options_;
  std::vector<float> positions_, uvs_, normals_;
  std::vector<uint32_t> indices_;
  CornerTable table_;
  bool has_uv_ = false, has_normal_ = false;
  uint32_t furthest_[3] = {};
  const char* furthest_at_[3] = {};
};

} // namespace

Mesh read_obj(const std::string& path, const MeshOptions& options) {
  return parse_obj(read_whole_file(path), path, options);
}

Mesh parse_obj(std::string_view text, const std::string& name, const MeshOptions& options) {
  return ObjParser(text, name, options).run();
}

} // namespace faceta
