#include "formats/measured_tensor.h"

#include "formats/byte_cursor.h"
#include "formats/output_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace faceta {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view kMagic = "tensor_file\0"sv;
constexpr size_t kFirstField = 18;
// No file of these databases comes near; they bound the time that a damaged header takes.
constexpr uint32_t kMaxFields = 1000;
constexpr uint16_t kMaxAxes = 32;

struct TypeInfo {
  const char* name;
  uint64_t size;
};
constexpr TypeInfo kTypes[] = {{"u8", 1},  {"i8", 1},  {"u16", 2}, {"i16", 2},
                               {"u32", 4}, {"i32", 4}, {"u64", 8}, {"i64", 8},
                               {"f16", 2}, {"f32", 4}, {"f64", 8}};

const TypeInfo& info(TensorType type) {
  return kTypes[static_cast<size_t>(type) - 1];
}

std::string take_name(ByteCursor& cursor) {
  auto length = cursor.take<uint16_t>("the header");
  return std::string(cursor.take_bytes(length, "the name of a field"));
}

// The rest of a field's header, behind its name.
TensorField take_field(const InputText& input, ByteCursor& cursor, std::string name) {
  const std::string what = "the header of field '" + name + "'";
  TensorField field{std::move(name), TensorType::f32, {}, {}};
  auto axes = cursor.take<uint16_t>(what);
  const char* at = cursor.at();
  if (axes > kMaxAxes)
    throw input.error_at_byte(
        at, fmt::format("field '{}' has {} axes, more than {}", field.name, axes, kMaxAxes));
  auto type = cursor.take<uint8_t>(what);
  if (type < 1 || type > std::size(kTypes))
    throw input.error_at_byte(at, fmt::format("field '{}' has the unknown type {} (known: 1 to {})",
                                              field.name, type, std::size(kTypes)));
  field.type = static_cast<TensorType>(type);
  auto offset = cursor.take<uint64_t>(what);
  uint64_t size = info(field.type).size;
  const uint64_t limit = input.text.size();
  for (int axis = 0; axis < axes; ++axis) {
    field.shape.push_back(cursor.take<uint64_t>(what));
    size = bounded_product({size, field.shape.back()}, limit);
  }
  if (offset > limit || size > limit - offset)
    throw input.error_at_byte(at, fmt::format("the values of field '{}' ({} x {} from byte {}) do "
                                              "not lie inside the file of {} bytes",
                                              field.name, fmt::join(field.shape, " x "),
                                              name_of(field.type), offset, limit));
  field.bytes = input.text.substr(offset, size);
  return field;
}

} // namespace

const char* name_of(TensorType type) {
  return info(type).name;
}

bool is_tensor_file(std::string_view bytes) {
  return bytes.starts_with(kMagic);
}

TensorFile::TensorFile(const InputText& input) : input_(input) {
  ByteCursor cursor(input_);
  if (cursor.take_bytes(kMagic.size(), "the header") != kMagic)
    throw input_.error_at_byte(input_.text.data(), "not a tensor_file");
  auto major = cursor.take<uint8_t>("the header"), minor = cursor.take<uint8_t>("the header");
  if (major != 1 || minor != 0)
    throw input_.error_at_byte(cursor.at() - 2,
                               fmt::format("version {}.{} of tensor_file is not known, only 1.0 is",
                                           int(major), int(minor)));
  auto count = cursor.take<uint32_t>("the header");
  if (count > kMaxFields)
    throw input_.error_at_byte(cursor.at() - 4, fmt::format("the header declares {} fields, more "
                                                            "than {}",
                                                            count, kMaxFields));
  for (uint32_t i = 0; i < count; ++i) {
    const char* at = cursor.at();
    std::string name = take_name(cursor);
    if (find(name))
      throw input_.error_at_byte(at, "field '" + name + "' is there twice");
    fields_.push_back(take_field(input_, cursor, std::move(name)));
  }
}

bool declares_tensor(std::string_view bytes, std::string_view name) {
  InputText input{bytes, {}};
  try {
    ByteCursor cursor(input, std::min(kFirstField, bytes.size()));
    while (true) {
      if (take_name(cursor) == name)
        return true;
      auto axes = cursor.take<uint16_t>({});
      cursor.take_bytes(1 + 8 + 8 * uint64_t(axes), {});
    }
  } catch (const Error&) {
    return false; // the header ends here
  }
}

const TensorField* TensorFile::find(std::string_view name) const {
  auto found = std::find_if(fields_.begin(), fields_.end(),
                            [&](const TensorField& field) { return field.name == name; });
  return found == fields_.end() ? nullptr : &*found;
}

const TensorField& TensorFile::require(std::string_view name, TensorType type,
                                       const std::vector<uint64_t>& shape) const {
  const TensorField* field = find(name);
  if (!field) {
    std::vector<std::string> names;
    for (const TensorField& f : fields_)
      names.push_back(f.name);
    throw Error(fmt::format("the file has no field '{}'", name), {input_.name},
                fmt::format("it has: {}", fmt::join(names, ", ")));
  }
  bool fits = field->type == type && field->shape.size() == shape.size();
  for (size_t axis = 0; fits && axis < shape.size(); ++axis)
    fits = field->shape[axis] > 0 && (shape[axis] == 0 || field->shape[axis] == shape[axis]);
  if (fits)
    return *field;
  std::string expected;
  for (uint64_t size : shape)
    expected += (size == 0 ? "n" : std::to_string(size)) + " x ";
  throw error(field, fmt::format("field '{}' is {} x {}, it must be {}{}", name,
                                 fmt::join(field->shape, " x "), name_of(field->type), expected,
                                 name_of(type)));
}

std::vector<float> TensorFile::finite_floats(const TensorField& field) const {
  std::vector<float> values(field.bytes.size() / sizeof(float));
  std::memcpy(values.data(), field.bytes.data(), values.size() * sizeof(float));
  auto bad = std::find_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
  if (bad != values.end())
    throw input_.error_at_byte(field.bytes.data() + (bad - values.begin()) * sizeof(float),
                               "field '" + field.name + "' holds a value that is not finite");
  return values;
}

Error TensorFile::error(const TensorField* field, const std::string& message) const {
  return input_.error_at_byte(field ? field->bytes.data() : input_.text.data() + input_.text.size(),
                              message);
}

void write_tensor_file(const std::string& path, const std::vector<TensorField>& fields) {
  auto put = [](std::string& out, auto value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  auto aligned = [](uint64_t offset) { return (offset + 7) / 8 * 8; };
  uint64_t offset = kFirstField;
  for (const TensorField& field : fields)
    offset += 2 + field.name.size() + 2 + 1 + 8 + 8 * field.shape.size();

  std::string header(kMagic);
  put(header, uint8_t{1});
  put(header, uint8_t{0});
  put(header, static_cast<uint32_t>(fields.size()));
  for (const TensorField& field : fields) {
    offset = aligned(offset);
    put(header, static_cast<uint16_t>(field.name.size()));
    header += field.name;
    put(header, static_cast<uint16_t>(field.shape.size()));
    put(header, static_cast<uint8_t>(field.type));
    put(header, offset);
    for (uint64_t size : field.shape)
      put(header, size);
    offset += field.bytes.size();
  }

  OutputFile file(path);
  file.write(header);
  uint64_t written = header.size();
  for (const TensorField& field : fields) {
    file.write(std::string(aligned(written) - written, '\0'));
    file.write(field.bytes);
    written = aligned(written) + field.bytes.size();
  }
  file.commit();
}

} // namespace faceta
