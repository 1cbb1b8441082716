#include "verify/quadrature.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <vector>

namespace faceta {

namespace {

// Kronrod's 7 nodes; the odd ones are Gauss's 3.
constexpr double kNodes[7] = {-0.9604912687080202, -0.7745966692414834, -0.4342437493468026, 0,
                              0.4342437493468026,  0.7745966692414834,  0.9604912687080202};
constexpr double kWeights[7] = {0.1046562260264673, 0.2684880898683334, 0.4013974147759622,
                                0.4509165386584741, 0.4013974147759622, 0.2684880898683334,
                                0.1046562260264673};
constexpr double kGauss[7] = {0, 5.0 / 9, 0, 8.0 / 9, 0, 5.0 / 9, 0};

struct Piece {
  Rectangle area;
  double value, error;
  bool along_x;   ///< where to halve it
  double largest; ///< |f| at the nodes
  bool operator<(const Piece& other) const { return error < other.error; }
};

Piece measure(const PlaneFunction& f, const Rectangle& area) {
  double hx = 0.5 * (area.x1 - area.x0), hy = 0.5 * (area.y1 - area.y0);
  double cx = 0.5 * (area.x1 + area.x0), cy = 0.5 * (area.y1 + area.y0);
  double both = 0, gauss_x = 0, gauss_y = 0, largest = 0;
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j) {
      double v = f(cx + hx * kNodes[i], cy + hy * kNodes[j]);
      largest = std::max(largest, std::abs(v));
      both += kWeights[i] * kWeights[j] * v;
      gauss_x += kGauss[i] * kWeights[j] * v;
      gauss_y += kWeights[i] * kGauss[j] * v;
    }
  double scale = hx * hy, ex = std::abs(both - gauss_x), ey = std::abs(both - gauss_y);
  return {area, both * scale, (ex + ey) * scale, ex > ey, largest};
}

// Distances from a border, as shares of the width, that a peak too narrow for the nodes is looked
// for at; pieces of a graded subdivision lie between them.
constexpr double kGrades[] = {1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5};
constexpr int kGradeCount = 9;

// Whether f is much larger somewhere along the border than at the nodes of the first rule.
bool peaks_at_border(const PlaneFunction& f, const Rectangle& area, double largest_node) {
  double wx = area.x1 - area.x0, wy = area.y1 - area.y0;
  for (int i = 0; i < 2 * kGradeCount - 1; i += 2)
    for (int j = 0; j < 2 * kGradeCount - 1; j += 2) {
      double gx = kGrades[std::min(i, 2 * kGradeCount - 2 - i)];
      double gy = kGrades[std::min(j, 2 * kGradeCount - 2 - j)];
      double x = i < kGradeCount ? area.x0 + wx * gx : area.x1 - wx * gx;
      double y = j < kGradeCount ? area.y0 + wy * gy : area.y1 - wy * gy;
      if (std::abs(f(x, y)) > 4 * largest_node)
        return true;
    }
  return false;
}

std::vector<double> even(double low, double high, int parts) {
  std::vector<double> borders;
  for (int i = 0; i <= parts; ++i)
    borders.push_back(low + (high - low) * i / parts);
  return borders;
}

std::vector<double> graded(double low, double high) {
  std::vector<double> borders = {low};
  for (int i = 0; i < kGradeCount; ++i)
    borders.push_back(low + (high - low) * kGrades[i]);
  for (int i = kGradeCount - 2; i >= 0; --i)
    borders.push_back(high - (high - low) * kGrades[i]);
  borders.push_back(high);
  return borders;
}

} // namespace

Integral integrate(const PlaneFunction& f, const Rectangle& area, double absolute, double relative,
                   long max_evaluations, int parts) {
  std::priority_queue<Piece> pieces;
  Piece whole = measure(f, area);
  Integral sum{0, 0, 49 + 81};
  auto push = [&](const Piece& piece) {
    sum.value += piece.value;
    sum.error += piece.error;
    pieces.push(piece);
  };
  bool peak = peaks_at_border(f, area, whole.largest);
  if (peak || parts > 1) {
    std::vector<double> x = peak ? graded(area.x0, area.x1) : even(area.x0, area.x1, parts);
    std::vector<double> y = peak ? graded(area.y0, area.y1) : even(area.y0, area.y1, parts);
    for (size_t i = 0; i + 1 < x.size(); ++i)
      for (size_t j = 0; j + 1 < y.size(); ++j)
        push(measure(f, {x[i], x[i + 1], y[j], y[j + 1]}));
    sum.evaluations += 49 * long(x.size() - 1) * long(y.size() - 1);
  } else {
    push(whole);
  }
  while (sum.error > std::max(absolute, relative * std::abs(sum.value)) &&
         sum.evaluations + 98 <= max_evaluations) {
    Piece worst = pieces.top();
    pieces.pop();
    Rectangle a = worst.area, b = worst.area;
    double middle_x = 0.5 * (a.x0 + a.x1), middle_y = 0.5 * (a.y0 + a.y1);
    if (worst.along_x)
      a.x1 = b.x0 = middle_x;
    else
      a.y1 = b.y0 = middle_y;
    sum.value -= worst.value;
    sum.error -= worst.error;
    push(measure(f, a));
    push(measure(f, b));
    sum.evaluations += 98;
  }
  // The running sums cancel badly after many steps: add the pieces anew.
  sum.value = sum.error = 0;
  for (; !pieces.empty(); pieces.pop()) {
    sum.value += pieces.top().value;
    sum.error += pieces.top().error;
  }
  return sum;
}

} // namespace faceta
