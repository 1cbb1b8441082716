#include "cli/progress.h"

#include <cmath>
#include <csignal>
#include <cstdio>
#include <string>
#include <unistd.h>

namespace faceta::cli {

namespace {

std::atomic<bool> interrupted{false};

void on_interrupt(int) {
  if (interrupted.exchange(true))
    _exit(130);
}

std::string duration(double seconds) {
  char text[32];
  if (seconds < 60)
    std::snprintf(text, sizeof text, "%.1fs", seconds);
  else
    std::snprintf(text, sizeof text, "%dm%02ds", int(seconds) / 60, int(seconds) % 60);
  return text;
}

} // namespace

ProgressLine::ProgressLine(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO)) {}

void ProgressLine::update(const Progress& p) {
  if (quiet_)
    return;
  double eta = p.fraction > 0 ? p.seconds / p.fraction - p.seconds : 0;
  double rate = p.seconds > 0 ? double(p.rays) / p.seconds * 1e-6 : 0;
  // Rays are counted when a pass ends; before the first they are not known.
  char speed[32] = "";
  if (p.rays)
    std::snprintf(speed, sizeof speed, "  %.1f Mrays/s", rate);
  char tail[160];
  std::snprintf(tail, sizeof tail, "%lld/%lld spp%s  %s, ETA %s", static_cast<long long>(p.samples),
                static_cast<long long>(p.total_samples), speed, duration(p.seconds).c_str(),
                duration(eta).c_str());
  if (terminal_) {
    constexpr int kWidth = 28;
    auto filled = static_cast<int>(std::lround(p.fraction * kWidth));
    std::string bar = std::string(filled, '=') + std::string(kWidth - filled, ' ');
    std::fprintf(stderr, "\r[%s] %s\x1b[K", bar.c_str(), tail);
    std::fflush(stderr);
    open_ = true;
  } else if (int tenths = static_cast<int>(p.fraction * 10); tenths > shown_tenths_) {
    shown_tenths_ = tenths;
    std::fprintf(stderr, "%3d %%  %s\n", tenths * 10, tail);
  }
}

void ProgressLine::finish() {
  if (open_)
    std::fputc('\n', stderr);
  open_ = false;
}

InterruptFlag::InterruptFlag() {
  interrupted = false;
  std::signal(SIGINT, on_interrupt);
}
InterruptFlag::~InterruptFlag() {
  std::signal(SIGINT, SIG_DFL);
}
const std::atomic<bool>& InterruptFlag::flag() const {
  return interrupted;
}

} // namespace faceta::cli
