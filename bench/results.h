#pragma once

/// Measured numbers: printed as tables by each benchmark, kept as a list in a JSON file.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace faceta::bench {

/// A list of objects name, isa, unit, value, against. `against` says what the value is compared
/// with: a goal, another kernel, Embree alone; null where it stands for itself.
class Results {
public:
  void add(const std::string& name, const std::string& isa, const std::string& unit, double value,
           const std::string& against = {});
  /// Writes the list, making the folders on the way. An empty path writes nothing.
  void write(const std::string& path) const;

private:
  nlohmann::ordered_json rows_ = nlohmann::ordered_json::array();
};

/// The middle value, or the mean of the two in the middle; NaN of none.
double median(std::vector<double> values);

/// Denormals count as zero while it lives, as they do while rendering.
class FlushDenormals {
public:
  FlushDenormals();
  ~FlushDenormals();

private:
  unsigned saved_;
};

/// Seconds of wall time, from an arbitrary start.
double wall_seconds();
/// Seconds that the processors spent in this process: what neighbours do to the machine does not
/// enter, but for the caches.
double cpu_seconds();

} // namespace faceta::bench
