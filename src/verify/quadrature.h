#pragma once

/// Adaptive integration over rectangles.

#include <functional>

namespace faceta {

/// [x0, x1] x [y0, y1].
struct Rectangle {
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
};

struct Integral {
  double value = 0;
  double error = 0; ///< estimate, not a bound
  long evaluations = 0;
};

using PlaneFunction = std::function<double(double x, double y)>;

/// Integrates f over a rectangle: the tensor product of Gauss-Kronrod's 3- and 7-point rules
/// (Laurie 1997, "Calculation of Gauss-Kronrod quadrature rules"); rectangles whose two rules
/// differ too much are halved along the axis with the larger difference. Stops when the estimated
/// error is below max(absolute, relative |value|) or after `max_evaluations`, whose rest is in
/// `error`. f is never evaluated on the border. Begins with `parts` x `parts` rectangles: steps of
/// f that are nearer to a border than the outermost node, 2 % of the width, are not seen.
Integral integrate(const PlaneFunction& f, const Rectangle& area, double absolute,
                   double relative = 0, long max_evaluations = 200000, int parts = 1);

} // namespace faceta
