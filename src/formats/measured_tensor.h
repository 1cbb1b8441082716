#pragma once

/// The container "tensor_file" 1.0 of the material databases of EPFL and KAIST: named arrays.
///
///     char[12] "tensor_file\0", u8 major, u8 minor, u32 number of fields, then for each field
///     u16 length and bytes of the name, u16 number of axes, u8 type, u64 offset, u64 shape[axes];
///     the values lie in C order at the offset from the start of the file.
///
/// All little-endian. Source: the writer in Mitsuba 3 (include/mitsuba/core/tensor.h), files.

#include "formats/input_text.h"

#include <cstdint>
#include <vector>

namespace faceta {

enum class TensorType : uint8_t { u8 = 1, i8, u16, i16, u32, i32, u64, i64, f16, f32, f64 };

/// "f32"
const char* name_of(TensorType type);

/// One array. Its bytes belong to the file (or to whoever writes it) and need not be aligned.
struct TensorField {
  std::string name;
  TensorType type = TensorType::f32;
  std::vector<uint64_t> shape;
  std::string_view bytes;
};

/// The fields of a file, which must outlive this.
class TensorFile {
public:
  /// Error if the bytes are no such container, or if a field lies outside of them.
  explicit TensorFile(const InputText& input);

  const std::vector<TensorField>& fields() const { return fields_; }
  /// Null if there is none of that name.
  const TensorField* find(std::string_view name) const;
  /// A field that must be there with this type and this shape, in which 0 stands for any size but
  /// 0. Error otherwise.
  const TensorField& require(std::string_view name, TensorType type,
                             const std::vector<uint64_t>& shape) const;
  /// The values of a field of f32. Error at the first one that is not finite.
  std::vector<float> finite_floats(const TensorField& field) const;
  /// An error at the first byte of a field, or at the end of the file if it is null.
  Error error(const TensorField* field, const std::string& message) const;

private:
  InputText input_;
  std::vector<TensorField> fields_;
};

/// True if the bytes begin as such a container does.
bool is_tensor_file(std::string_view bytes);

/// True if the container, which may be damaged, declares a field of this name.
bool declares_tensor(std::string_view bytes, std::string_view name);

/// Writes a container, values at multiples of 8 bytes. Error as of OutputFile.
void write_tensor_file(const std::string& path, const std::vector<TensorField>& fields);

} // namespace faceta
