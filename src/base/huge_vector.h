#pragma once

#include <cstdlib>
#include <new>
#include <vector>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace faceta {

/// Asks the system for huge pages for large blocks: what is looked up at random in tens of
/// megabytes otherwise pays for an address translation with every access. Blocks start on cache
/// lines.
template <class E> struct HugeAllocator {
  using value_type = E;
  HugeAllocator() = default;
  template <class F> HugeAllocator(const HugeAllocator<F>&) {}

  E* allocate(size_t n) {
    constexpr size_t kPage = size_t(1) << 21;
    size_t bytes = n * sizeof(E);
    size_t alignment = bytes >= kPage ? kPage : 64;
    bytes = (bytes + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, bytes);
    if (!memory)
      throw std::bad_alloc();
#if defined(__linux__)
    if (alignment == kPage)
      madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<E*>(memory);
  }
  void deallocate(E* memory, size_t) { std::free(memory); }
  template <class F> bool operator==(const HugeAllocator<F>&) const { return true; }
};

template <class E> using HugeVector = std::vector<E, HugeAllocator<E>>;

} // namespace faceta
