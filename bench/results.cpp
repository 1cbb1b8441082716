#include "results.h"

#include "formats/output_file.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <xmmintrin.h>

namespace faceta::bench {

void Results::add(const std::string& name, const std::string& isa, const std::string& unit,
                  double value, const std::string& against) {
  nlohmann::ordered_json row;
  row["name"] = name;
  row["isa"] = isa;
  row["unit"] = unit;
  row["value"] = value;
  row["against"] = nullptr;
  if (!against.empty())
    row["against"] = against;
  rows_.push_back(std::move(row));
}

void Results::write(const std::string& path) const {
  if (path.empty())
    return;
  std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty())
    std::filesystem::create_directories(folder);
  OutputFile file(path);
  file.write(rows_.dump(1) + "\n");
  file.commit();
}

double median(std::vector<double> values) {
  if (values.empty())
    return std::nan("");
  std::sort(values.begin(), values.end());
  size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) {
  _mm_setcsr(saved_ | 0x8040);
}

FlushDenormals::~FlushDenormals() {
  _mm_setcsr(saved_);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

} // namespace faceta::bench
