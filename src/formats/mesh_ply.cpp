#include "formats/mesh_ply.h"

#include "formats/ply_header.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace faceta {

namespace {

static_assert(std::endian::native == std::endian::little);

float half_to_float(uint16_t bits) {
  int exponent = bits >> 10 & 31, mantissa = bits & 1023;
  float value = exponent == 0    ? std::ldexp(static_cast<float>(mantissa), -24)
                : exponent == 31 ? (mantissa ? std::numeric_limits<float>::quiet_NaN()
                                             : std::numeric_limits<float>::infinity())
                                 : std::ldexp(static_cast<float>(mantissa + 1024), exponent - 25);
  return bits & 0x8000 ? -value : value;
}

// One value after the other of a text body.
class AsciiBody {
public:
  AsciiBody(const InputText& source, size_t offset)
      : source_(source), p_(source.text.data() + offset),
        end_(source.text.data() + source.text.size()) {}

  float number(PlyType, const std::string& name) {
    const char* start = next_word(name);
    float value = 0;
    NumberStatus status = parse_float(p_, end_, value);
    if (status == NumberStatus::kMalformed || !at_separator())
      throw source_.error(start, "'" + word_at(start, end_) + "' is not a number, in property '" +
                                     name + "'");
    if (status == NumberStatus::kNotFinite)
      throw source_.error(start, "property '" + name + "' is not finite");
    return value;
  }

  int64_t integer(PlyType, const std::string& name) {
    const char* start = next_word(name);
    int64_t value = 0;
    auto result = std::from_chars(start, end_, value);
    p_ = result.ptr;
    if (result.ec != std::errc() || !at_separator())
      throw source_.error(start, "'" + word_at(start, end_) + "' is not an integer, in property '" +
                                     name + "'");
    return value;
  }

  void skip(PlyType, uint64_t count, const std::string& name) {
    for (uint64_t i = 0; i < count; ++i) {
      next_word(name);
      while (!at_separator())
        ++p_;
    }
  }

  Error error(const std::string& message) const { return source_.error(last_, message); }

  bool only_blanks_left() {
    while (p_ != end_ && at_separator())
      ++p_;
    last_ = p_;
    return p_ == end_;
  }

private:
  bool at_separator() const {
    return p_ == end_ || *p_ == ' ' || *p_ == '\n' || *p_ == '\r' || *p_ == '\t';
  }
  const char* next_word(const std::string& name) {
    if (only_blanks_left())
      throw source_.error(p_, "the file ends before property '" + name + "'");
    return p_;
  }

  const InputText& source_;
  const char* p_;
  const char* end_;
  const char* last_ = p_; // the value read last
};

// One value after the other of a binary body.
class BinaryBody {
public:
  BinaryBody(const InputText& source, size_t offset, bool swap)
      : source_(source), p_(source.text.data() + offset),
        end_(source.text.data() + source.text.size()), swap_(swap) {}

  float number(PlyType type, const std::string& name) {
    const char* start = p_;
    float value = 0;
    switch (type) {
    case PlyType::kF32:
      value = std::bit_cast<float>(take<uint32_t>(name));
      break;
    case PlyType::kF64:
      value = static_cast<float>(std::bit_cast<double>(take<uint64_t>(name)));
      break;
    case PlyType::kF16:
      value = half_to_float(take<uint16_t>(name));
      break;
    default:
      value = static_cast<float>(integer(type, name));
    }
    if (!std::isfinite(value))
      throw source_.error_at_byte(start, "property '" + name + "' is not finite");
    return value;
  }

  int64_t integer(PlyType type, const std::string& name) {
    switch (type) {
    case PlyType::kI8:
      return static_cast<int8_t>(take<uint8_t>(name));
    case PlyType::kU8:
      return take<uint8_t>(name);
    case PlyType::kI16:
      return static_cast<int16_t>(take<uint16_t>(name));
    case PlyType::kU16:
      return take<uint16_t>(name);
    case PlyType::kI32:
      return static_cast<int32_t>(take<uint32_t>(name));
    case PlyType::kU32:
      return take<uint32_t>(name);
    default:
      // Of ulong, the upper half reads as negative: out of range for every use.
      return static_cast<int64_t>(take<uint64_t>(name));
    }
  }

  void skip(PlyType type, uint64_t count, const std::string& name) {
    if (count > static_cast<uint64_t>(end_ - p_) / size_of(type))
      throw ends_early(name);
    p_ += count * size_of(type);
  }

  Error error(const std::string& message) const { return source_.error_at_byte(last_, message); }

  bool only_blanks_left() {
    last_ = p_;
    return std::all_of(p_, end_,
                       [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; });
  }

private:
  template <class T> T take(const std::string& name) {
    if (static_cast<size_t>(end_ - p_) < sizeof(T))
      throw ends_early(name);
    T value;
    last_ = p_;
    std::memcpy(&value, p_, sizeof(T));
    p_ += sizeof(T);
    if (swap_) {
      auto* bytes = reinterpret_cast<unsigned char*>(&value);
      std::reverse(bytes, bytes + sizeof(T));
    }
    return value;
  }
  Error ends_early(const std::string& name) const {
    return source_.error_at_byte(p_, "the file ends before property '" + name + "'");
  }

  const InputText& source_;
  const char* p_;
  const char* end_;
  const char* last_ = p_; // the value read last
  bool swap_;
};

// Where the numbers of a vertex go: x y z nx ny nz u v.
constexpr int kSlots = 8;
constexpr int kSkipped = -1;

class PlyBuilder {
public:
  PlyBuilder(const InputText& source, const PlyHeader& header, const MeshOptions& options)
      : source_(source), header_(header), options_(options) {
    for (const PlyElement& element : header.elements) {
      if (element.name == "vertex")
        vertices_ = element.count;
      if (element.name == "tristrips" && element.count > 0)
        throw Error("triangle strips in PLY files are not supported", {source.name},
                    "write the faces as an element 'face' with a list 'vertex_indices'");
    }
    if (vertices_ >= std::numeric_limits<uint32_t>::max())
      throw Error("the mesh is too large", {source.name});
  }

  template <class Body> Mesh run(Body body) {
    bool has_vertices = false;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        read_vertices(body, element), has_vertices = true;
      else if (element.name == "face")
        read_faces(body, element);
      else
        skip_element(body, element);
    }
    if (!has_vertices)
      throw Error("the PLY file has no element 'vertex'", {source_.name});
    if (!body.only_blanks_left())
      throw body.error("the file goes on after its last element");
    if (options_.face_normals)
      mesh_.normals.clear();
    mesh_.face_normals = options_.face_normals;
    mesh_.flip_normals = options_.flip_normals;
    return std::move(mesh_);
  }

private:
  static int find(const PlyElement& element, const char* name) {
    for (size_t i = 0; i < element.properties.size(); ++i)
      if (!element.properties[i].is_list && element.properties[i].name == name)
        return static_cast<int>(i);
    return -1;
  }

  // The first group of names that is there in full is bound to the slots from `first` on.
  static bool bind(const PlyElement& element, std::vector<int>& slots, int first,
                   std::initializer_list<const char*> names) {
    for (const char* name : names)
      if (find(element, name) < 0)
        return false;
    for (const char* name : names)
      slots[static_cast<size_t>(find(element, name))] = first++;
    return true;
  }

  template <class Body> static void skip_property(Body& body, const PlyProperty& property) {
    uint64_t count = 1;
    if (property.is_list) {
      int64_t length = body.integer(property.count_type, property.name);
      if (length < 0)
        throw body.error("list '" + property.name + "' has a negative length");
      count = static_cast<uint64_t>(length);
    }
    body.skip(property.type, count, property.name);
  }

  template <class Body> void skip_element(Body& body, const PlyElement& element) {
    mesh_.ignored_attributes.push_back(element.name);
    if (element.properties.empty())
      return;
    for (uint64_t row = 0; row < element.count; ++row)
      for (const PlyProperty& property : element.properties)
        skip_property(body, property);
  }

  template <class Body> void read_vertices(Body& body, const PlyElement& element) {
    std::vector<int> slots(element.properties.size(), kSkipped);
    if (!bind(element, slots, 0, {"x", "y", "z"}))
      throw Error("element 'vertex' of the PLY file lacks x, y or z", {source_.name});
    bool has_normals = bind(element, slots, 3, {"nx", "ny", "nz"});
    bool has_uvs = bind(element, slots, 6, {"u", "v"}) ||
                   bind(element, slots, 6, {"texture_u", "texture_v"}) ||
                   bind(element, slots, 6, {"s", "t"});
    for (size_t i = 0; i < slots.size(); ++i)
      if (slots[i] == kSkipped)
        mesh_.ignored_attributes.push_back("vertex_" + element.properties[i].name);
    mesh_.positions.reserve(3 * element.count);
    mesh_.normals.reserve(has_normals ? 3 * element.count : 0);
    mesh_.uvs.reserve(has_uvs ? 2 * element.count : 0);
    for (uint64_t row = 0; row < element.count; ++row) {
      float values[kSlots] = {};
      for (size_t i = 0; i < slots.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        if (slots[i] == kSkipped)
          skip_property(body, property);
        else
          values[slots[i]] = body.number(property.type, property.name);
      }
      store_vertex(values, has_normals, has_uvs);
    }
  }

  void store_vertex(const float* values, bool has_normals, bool has_uvs) {
    mesh_.positions.insert(mesh_.positions.end(), values, values + 3);
    if (has_normals) {
      double length = std::hypot(double{values[3]}, double{values[4]}, double{values[5]});
      for (int k = 3; k < 6; ++k)
        mesh_.normals.push_back(length > 0 ? static_cast<float>(values[k] / length) : 0.0f);
    }
    if (has_uvs) {
      mesh_.uvs.push_back(values[6]);
      mesh_.uvs.push_back(options_.flip_tex_coords ? 1.0f - values[7] : values[7]);
    }
  }

  static int find_index_list(const PlyElement& element) {
    for (size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.is_list && is_integer(property.type) &&
          (property.name == "vertex_indices" || property.name == "vertex_index"))
        return static_cast<int>(i);
    }
    return -1;
  }

  template <class Body> void read_faces(Body& body, const PlyElement& element) {
    int list = find_index_list(element);
    if (list < 0 && element.count > 0)
      throw Error("element 'face' of the PLY file has no list of corners", {source_.name},
                  "expected 'property list uchar int vertex_indices'");
    for (size_t i = 0; i < element.properties.size(); ++i)
      if (static_cast<int>(i) != list)
        mesh_.ignored_attributes.push_back("face_" + element.properties[i].name);
    for (uint64_t row = 0; row < element.count; ++row)
      for (size_t i = 0; i < element.properties.size(); ++i) {
        if (static_cast<int>(i) == list)
          read_polygon(body, element.properties[i]);
        else
          skip_property(body, element.properties[i]);
      }
  }

  template <class Body> void read_polygon(Body& body, const PlyProperty& property) {
    int64_t corners = body.integer(property.count_type, property.name);
    if (corners < 0)
      throw body.error("a face has a negative number of corners");
    uint32_t first = 0, previous = 0;
    for (int64_t n = 0; n < corners; ++n) {
      int64_t index = body.integer(property.type, property.name);
      if (index < 0 || static_cast<uint64_t>(index) >= vertices_)
        throw body.error("vertex index " + std::to_string(index) + " is out of range: there are " +
                         std::to_string(vertices_) + " vertices");
      auto id = static_cast<uint32_t>(index);
      if (n == 0)
        first = id;
      else if (n >= 2)
        mesh_.indices.insert(mesh_.indices.end(), {first, previous, id});
      previous = id;
    }
  }

  const InputText& source_;
  const PlyHeader& header_;
  MeshOptions options_;
  uint64_t vertices_ = 0;
  Mesh mesh_;
};

} // namespace

Mesh read_ply(const std::string& path, const MeshOptions& options) {
  return parse_ply(read_whole_file(path), path, options);
}

Mesh parse_ply(std::string_view bytes, const std::string& name, const MeshOptions& options) {
  InputText source{bytes, name};
  PlyHeader header = parse_ply_header(source);
  PlyBuilder builder(source, header, options);
  if (header.encoding == PlyEncoding::kAscii)
    return builder.run(AsciiBody(source, header.data_offset));
  return builder.run(
      BinaryBody(source, header.data_offset, header.encoding == PlyEncoding::kBigEndian));
}

} // namespace faceta
