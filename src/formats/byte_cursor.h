#pragma once

/// Little-endian numbers out of the bytes of a binary file, whatever their alignment.

#include "formats/input_text.h"

#include <bit>
#include <cstdint>
#include <cstring>

namespace faceta {

static_assert(std::endian::native == std::endian::little);

/// The number whose bytes start at p.
template <class T> T load(const char* p) {
  T value;
  std::memcpy(&value, p, sizeof(T));
  return value;
}

/// The product of sizes that a file declares, or limit + 1 if it is above the limit.
inline uint64_t bounded_product(std::initializer_list<uint64_t> factors, uint64_t limit) {
  uint64_t product = 1;
  for (uint64_t factor : factors)
    if (factor == 0)
      return 0;
  for (uint64_t factor : factors) {
    if (factor > limit / product)
      return limit + 1;
    product *= factor;
  }
  return product;
}

/// Walks over a file's bytes. Every step is checked against its end: Error, naming what was to be
/// read there.
class ByteCursor {
public:
  explicit ByteCursor(const InputText& input, size_t offset = 0)
      : input_(input), p_(input.text.data() + offset), end_(input.text.data() + input.text.size()) {
  }

  const char* at() const { return p_; }
  uint64_t left() const { return static_cast<uint64_t>(end_ - p_); }

  std::string_view take_bytes(uint64_t count, const std::string& what) {
    if (count > left())
      throw input_.error_at_byte(p_, "the file ends inside " + what + " (" +
                                         std::to_string(left()) + " of " + std::to_string(count) +
                                         " bytes are there)");
    std::string_view bytes(p_, static_cast<size_t>(count));
    p_ += count;
    return bytes;
  }
  template <class T> T take(const std::string& what) {
    return load<T>(take_bytes(sizeof(T), what).data());
  }

private:
  const InputText& input_;
  const char* p_;
  const char* end_;
};

} // namespace faceta
