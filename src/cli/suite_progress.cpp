#include "cli/suite_progress.h"

#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace faceta::cli {

SuiteProgressLine::SuiteProgressLine(bool quiet, const char* what)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO)), what_(what) {}

SuiteProgressLine::~SuiteProgressLine() {
  if (open_)
    std::fputs("\r\x1b[K", stderr);
}

void SuiteProgressLine::update(const SuiteProgress& p) {
  if (quiet_)
    return;
  std::string count = fmt::format("{}/{} {}, {:.0f} s", p.done, p.total, what_, p.seconds);
  if (terminal_) {
    constexpr size_t kWidth = 28;
    std::string bar(p.total ? kWidth * p.done / p.total : 0, '=');
    fmt::print(stderr, "\r[{:<{}}] {}  {:.36}\x1b[K", bar, kWidth, count, p.name);
    std::fflush(stderr);
    open_ = true;
  } else if (size_t tenths = p.total ? 10 * p.done / p.total : 0; tenths > shown_tenths_) {
    shown_tenths_ = tenths;
    fmt::print(stderr, "{:3} %  {}\n", 10 * tenths, count);
  }
}

} // namespace faceta::cli
