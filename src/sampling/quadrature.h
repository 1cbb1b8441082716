#pragma once

#include <cmath>
#include <vector>

namespace faceta {

/// Points and weights of an integral.
struct Quadrature {
  std::vector<double> nodes, weights;
};

/// Gauss-Legendre quadrature on [0, 1] with n >= 1 nodes, exact for polynomials up to degree 2n -
/// 1: Newton's method on the Legendre polynomial from Tricomi's estimate of its roots.
inline Quadrature gauss_legendre(int n) {
  Quadrature q{std::vector<double>(n), std::vector<double>(n)};
  for (int i = 0; i < n; ++i) {
    double x = -std::cos(3.14159265358979323846 * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 8; ++step) {
      double last = 1, value = x; // P_0, P_1 and the three-term recurrence
      for (int k = 2; k <= n; ++k) {
        double next = ((2 * k - 1) * x * value - (k - 1) * last) / k;
        last = value;
        value = next;
      }
      slope = n * (x * value - last) / (x * x - 1);
      x -= value / slope;
    }
    q.nodes[i] = 0.5 * (1 + x);
    q.weights[i] = 1 / ((1 - x * x) * slope * slope);
  }
  return q;
}

} // namespace faceta
