#pragma once

#include <vector>

namespace faceta {

/// A rectangle of an environment's cells and the weight of what is in it.
struct EnvironmentRectangle {
  int x, y, width, height;
  double weight;
};

/// Divides a grid of non-negative weights (row by row) into at most `limit` rectangles within which
/// they differ little, always splitting the one that a uniform choice inside serves worst. Small
/// tables stay in cache; a sun of one pixel still gets a rectangle of its own.
std::vector<EnvironmentRectangle> divide_environment(const std::vector<double>& weights,
                                                     int columns, int rows, int limit);

} // namespace faceta
