#include "base/huge_pages.h"

#if defined(__linux__)
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <sys/mman.h>
#endif

namespace faceta {

#if defined(__linux__)

namespace {

constexpr uintptr_t kHugePage = uintptr_t(1) << 21;
// Linux 6.1 and later; older kernels answer "invalid" and collapse what was advised in time.
constexpr int kCollapse = 25;

/// A private, anonymous, writable block of /proc/self/smaps.
struct Block {
  uintptr_t begin = 0, end = 0;
  bool usable = false;
};

/// A header line of smaps: "begin-end perms offset device inode [name]".
bool parse_header(const std::string& line, Block& block) {
  char permissions[8] = "";
  unsigned long inode = 1;
  int rest = 0;
  if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR " %7s %*x %*s %lu %n", &block.begin,
                  &block.end, permissions, &inode, &rest) < 4)
    return false;
  std::string name = line.substr(static_cast<size_t>(rest));
  block.usable =
      inode == 0 && std::string(permissions) == "rw-p" && (name.empty() || name == "[heap]");
  return true;
}

void advise(const Block& block) {
  uintptr_t begin = (block.begin + kHugePage - 1) / kHugePage * kHugePage;
  uintptr_t end = block.end / kHugePage * kHugePage;
  if (end <= begin)
    return;
  // The kernel names the block as text: there is no pointer to take it from.
  void* memory = reinterpret_cast<void*>(begin); // NOLINT(performance-no-int-to-ptr)
  if (madvise(memory, end - begin, MADV_HUGEPAGE) == 0)
    madvise(memory, end - begin, kCollapse);
}

} // namespace

void prefer_huge_pages() {
  std::ifstream file("/proc/self/smaps");
  std::string line;
  Block block;
  while (std::getline(file, line)) {
    unsigned long kilobytes = 0;
    if (parse_header(line, block))
      continue;
    // Mostly filled: a huge page under an empty stack would only cost memory.
    if (block.usable && std::sscanf(line.c_str(), "Rss: %lu kB", &kilobytes) == 1 &&
        kilobytes * 1024 >= (block.end - block.begin) / 4 * 3)
      advise(block);
  }
}

#else

void prefer_huge_pages() {}

#endif

} // namespace faceta
