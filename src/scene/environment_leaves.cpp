#include "scene/environment_leaves.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace faceta {

namespace {

/// Sums over rectangles in constant time.
class SummedArea {
public:
  SummedArea(const std::vector<double>& values, int columns, int rows)
      : columns_(columns), sums_(size_t(columns + 1) * (rows + 1), 0.0) {
    for (int y = 0; y < rows; ++y) {
      double row = 0;
      for (int x = 0; x < columns; ++x) {
        row += values[size_t(y) * columns + x];
        at(x + 1, y + 1) = at(x + 1, y) + row;
      }
    }
  }
  double sum(int x, int y, int width, int height) {
    return at(x + width, y + height) - at(x, y + height) - at(x + width, y) + at(x, y);
  }

private:
  double& at(int x, int y) { return sums_[size_t(y) * (columns_ + 1) + x]; }

  int columns_;
  std::vector<double> sums_;
};

struct Candidate {
  EnvironmentRectangle rectangle;
  double error;
  bool operator<(const Candidate& other) const { return error < other.error; }
};

class Divider {
public:
  Divider(const std::vector<double>& weights, int columns, int rows)
      : weights_(weights), columns_(columns), sums_(weights, columns, rows),
        squares_(squared(weights), columns, rows) {}

  /// The error of choosing uniformly inside: cells times the deviation of their weights.
  Candidate measure(int x, int y, int width, int height) {
    Candidate c{{x, y, width, height, 0}, 0};
    double n = double(width) * height;
    if (n == 1) {
      c.rectangle.weight = weights_[size_t(y) * columns_ + x];
      return c;
    }
    c.rectangle.weight = std::max(0.0, sums_.sum(x, y, width, height));
    double mean = c.rectangle.weight / n;
    double variance = squares_.sum(x, y, width, height) / n - mean * mean;
    c.error = n * std::sqrt(std::max(0.0, variance));
    return c;
  }

  void split(const EnvironmentRectangle& r, std::priority_queue<Candidate>& queue) {
    if (r.width >= r.height) {
      int half = r.width / 2;
      queue.push(measure(r.x, r.y, half, r.height));
      queue.push(measure(r.x + half, r.y, r.width - half, r.height));
    } else {
      int half = r.height / 2;
      queue.push(measure(r.x, r.y, r.width, half));
      queue.push(measure(r.x, r.y + half, r.width, r.height - half));
    }
  }

private:
  static std::vector<double> squared(std::vector<double> values) {
    for (double& v : values)
      v *= v;
    return values;
  }

  const std::vector<double>& weights_;
  int columns_;
  SummedArea sums_, squares_;
};

} // namespace

std::vector<EnvironmentRectangle> divide_environment(const std::vector<double>& weights,
                                                     int columns, int rows, int limit) {
  Divider divider(weights, columns, rows);
  std::priority_queue<Candidate> queue;
  queue.push(divider.measure(0, 0, columns, rows));
  while (static_cast<int>(queue.size()) < limit && queue.top().error > 0) {
    EnvironmentRectangle worst = queue.top().rectangle;
    queue.pop();
    divider.split(worst, queue);
  }
  std::vector<EnvironmentRectangle> rectangles;
  for (; !queue.empty(); queue.pop())
    rectangles.push_back(queue.top().rectangle);
  // In the order of the picture, so that neighbours lie side by side in memory.
  std::sort(rectangles.begin(), rectangles.end(),
            [](const auto& a, const auto& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  // Weights anew from the cells: differences of large sums lose the dim ones.
  for (EnvironmentRectangle& r : rectangles) {
    r.weight = 0;
    for (int y = r.y; y < r.y + r.height; ++y)
      for (int x = r.x; x < r.x + r.width; ++x)
        r.weight += weights[size_t(y) * columns + x];
  }
  return rectangles;
}

} // namespace faceta
