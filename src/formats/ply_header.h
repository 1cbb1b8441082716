#pragma once

#include "formats/mesh_input.h"

#include <cstdint>
#include <string>
#include <vector>

namespace faceta {

enum class PlyType { kI8, kU8, kI16, kU16, kI32, kU32, kI64, kU64, kF16, kF32, kF64 };

/// Size in bytes.
size_t size_of(PlyType type);
bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kF32;
  bool is_list = false;
  PlyType count_type = PlyType::kU8; ///< an integer type, of lists only
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  size_t data_offset = 0; ///< first byte behind the header
};

/// Reads the header up to and including end_header. Counts are checked against the size of the
/// file; elements and the properties of each have distinct names. Throws Error with line and
/// column.
PlyHeader parse_ply_header(const InputText& source);

} // namespace faceta
