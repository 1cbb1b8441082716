#pragma once

/// Derivatives as a number type: any model over Jet<double, N> gives its value and the derivatives
/// with respect to N of its parameters.

#include "base/maths.h"

#include <ceres/jet.h>

namespace faceta {

/// A value `a` with N derivatives `v`: ceres::Jet with the functions of this room. A type of our
/// own, so that templates written before this header find them by argument-dependent lookup, and so
/// that they win over those of ceres.
template <class S, int N> struct Jet : ceres::Jet<S, N> {
  using Base = ceres::Jet<S, N>;
  Jet() = default;
  Jet(const S& value) : Base(value) {}
  Jet(const Base& other) : Base(other) {}
  template <class V> Jet(const S& value, const V& derivatives) : Base(value, derivatives) {}

  const Base& base() const { return *this; }
  friend Jet operator-(const Jet& a) { return -a.base(); }
  friend Jet operator+(const Jet& a, const Jet& b) { return a.base() + b.base(); }
  friend Jet operator-(const Jet& a, const Jet& b) { return a.base() - b.base(); }
  friend Jet operator*(const Jet& a, const Jet& b) { return a.base() * b.base(); }
  friend Jet operator/(const Jet& a, const Jet& b) { return a.base() / b.base(); }
  Jet& operator+=(const Jet& b) { return *this = *this + b; }
  Jet& operator-=(const Jet& b) { return *this = *this - b; }
  Jet& operator*=(const Jet& b) { return *this = *this * b; }
  Jet& operator/=(const Jet& b) { return *this = *this / b; }
  friend bool operator<(const Jet& a, const Jet& b) { return a.a < b.a; }
  friend bool operator>(const Jet& a, const Jet& b) { return a.a > b.a; }
  friend bool operator<=(const Jet& a, const Jet& b) { return a.a <= b.a; }
  friend bool operator>=(const Jet& a, const Jet& b) { return a.a >= b.a; }
  friend bool operator==(const Jet& a, const Jet& b) { return a.a == b.a; }
  friend bool operator!=(const Jet& a, const Jet& b) { return a.a != b.a; }
};

template <class S, int N> struct NumberTraits<Jet<S, N>> {
  using Mask = bool;
  using Int = int32_t;
  using Uint = uint32_t;
  using Scalar = double;
  static constexpr int kWidth = 1;
  /// A Jet without derivatives is a plain number whose colours have another width than three: for
  /// the proof that models work with any.
  static constexpr int kChannels = N == 0 ? 6 : 3;
};

template <class S, int N> Jet<S, N> select(bool m, const Jet<S, N>& a, const Jet<S, N>& b) {
  return m ? a : b;
}
template <class S, int N> Jet<S, N> min(const Jet<S, N>& a, const Jet<S, N>& b) {
  return a < b ? a : b;
}
template <class S, int N> Jet<S, N> max(const Jet<S, N>& a, const Jet<S, N>& b) {
  return a > b ? a : b;
}
template <class S, int N>
Jet<S, N> fma(const Jet<S, N>& a, const Jet<S, N>& b, const Jet<S, N>& c) {
  return a * b + c;
}
// At 0 the slope of sqrt is infinite; 0 is what makes clamped expressions differentiable.
template <class S, int N> Jet<S, N> sqrt(const Jet<S, N>& a) {
  return a.a > S(0) ? Jet<S, N>(ceres::sqrt(a.base())) : Jet<S, N>(S(0));
}
template <class S, int N> Jet<S, N> abs(const Jet<S, N>& a) {
  return a.a < S(0) ? -a : a;
}
template <class S, int N> Jet<S, N> floor(const Jet<S, N>& a) {
  return Jet<S, N>(std::floor(a.a));
}
template <class S, int N> Jet<S, N> copysign(const Jet<S, N>& a, const Jet<S, N>& b) {
  return std::signbit(a.a) == std::signbit(b.a) ? a : -a;
}
template <class S, int N> bool is_finite(const Jet<S, N>& a) {
  return std::isfinite(a.a);
}
template <class S, int N> int32_t to_int(const Jet<S, N>& a) {
  return static_cast<int32_t>(a.a);
}
template <class S, int N> Jet<S, N> exp(const Jet<S, N>& a) {
  return ceres::exp(a.base());
}
template <class S, int N> Jet<S, N> log(const Jet<S, N>& a) {
  return ceres::log(a.base());
}
template <class S, int N> Jet<S, N> pow(const Jet<S, N>& a, const Jet<S, N>& b) {
  return a.a > S(0) ? Jet<S, N>(ceres::exp(b.base() * ceres::log(a.base())))
                    : Jet<S, N>(std::pow(a.a, b.a));
}
template <class S, int N> SinCos<Jet<S, N>> sincos(const Jet<S, N>& a) {
  return {Jet<S, N>(ceres::sin(a.base())), Jet<S, N>(ceres::cos(a.base()))};
}
template <class S, int N> Jet<S, N> sin(const Jet<S, N>& a) {
  return ceres::sin(a.base());
}
template <class S, int N> Jet<S, N> cos(const Jet<S, N>& a) {
  return ceres::cos(a.base());
}
template <class S, int N> Jet<S, N> tan(const Jet<S, N>& a) {
  return ceres::tan(a.base());
}
template <class S, int N> Jet<S, N> atan2(const Jet<S, N>& y, const Jet<S, N>& x) {
  return ceres::atan2(y.base(), x.base());
}
template <class S, int N> Jet<S, N> asin(const Jet<S, N>& a) {
  return ceres::asin(a.base());
}
template <class S, int N> Jet<S, N> acos(const Jet<S, N>& a) {
  return ceres::acos(a.base());
}
template <class S, int N> Jet<S, N> erf(const Jet<S, N>& a) {
  return Jet<S, N>(std::erf(a.a), 1.1283791670955126 * std::exp(-a.a * a.a) * a.v);
}
template <class S, int N> Jet<S, N> erfinv(const Jet<S, N>& a) {
  S y = erfinv(a.a);
  return Jet<S, N>(y, 0.88622692545275801365 * std::exp(y * y) * a.v);
}

} // namespace faceta
