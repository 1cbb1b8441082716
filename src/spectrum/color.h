#pragma once

/// The colour of light and of reflection, as models see it: componentwise arithmetic, nothing else.

#include "base/maths.h"

namespace faceta {

/// How many channels the colours over a number type have: 3, unless the type says otherwise.
template <class T> consteval int channels_of() {
  if constexpr (requires { NumberTraits<T>::kChannels; })
    return NumberTraits<T>::kChannels;
  else
    return 3;
}

/// N independent channels (3: linear sRGB; a spectral build carries hero wavelengths instead).
template <class T, int N = channels_of<T>()> struct Color {
  T c[N];

  Color() : Color(T(0)) {}
  FACETA_INLINE explicit Color(const T& grey) {
    for (T& channel : c)
      channel = grey;
  }
  FACETA_INLINE Color(const T& r, const T& g, const T& b)
    requires(N == 3)
      : c{r, g, b} {}

  static constexpr int size() { return N; }
  FACETA_INLINE T& operator[](int i) { return c[i]; }
  FACETA_INLINE const T& operator[](int i) const { return c[i]; }

  /// Applies a function to each channel.
  template <class F> FACETA_INLINE Color map(F f) const {
    Color r;
    for (int i = 0; i < N; ++i)
      r.c[i] = f(c[i]);
    return r;
  }
  template <class F> FACETA_INLINE Color map(const Color& other, F f) const {
    Color r;
    for (int i = 0; i < N; ++i)
      r.c[i] = f(c[i], other.c[i]);
    return r;
  }

  friend FACETA_INLINE Color operator+(const Color& a, const Color& b) {
    return a.map(b, [](const T& x, const T& y) { return x + y; });
  }
  friend FACETA_INLINE Color operator-(const Color& a, const Color& b) {
    return a.map(b, [](const T& x, const T& y) { return x - y; });
  }
  friend FACETA_INLINE Color operator*(const Color& a, const Color& b) {
    return a.map(b, [](const T& x, const T& y) { return x * y; });
  }
  friend FACETA_INLINE Color operator/(const Color& a, const Color& b) {
    return a.map(b, [](const T& x, const T& y) { return x / y; });
  }
  friend FACETA_INLINE Color operator*(const Color& a, const T& s) {
    return a.map([&](const T& x) { return x * s; });
  }
  friend FACETA_INLINE Color operator*(const T& s, const Color& a) { return a * s; }
  friend FACETA_INLINE Color operator-(const T& s, const Color& a) {
    return a.map([&](const T& x) { return s - x; });
  }
  FACETA_INLINE Color& operator+=(const Color& b) { return *this = *this + b; }
  FACETA_INLINE Color& operator*=(const Color& b) { return *this = *this * b; }
  FACETA_INLINE Color& operator*=(const T& s) { return *this = *this * s; }
};

template <class M, class T, int N>
FACETA_INLINE Color<T, N> select(const M& m, const Color<T, N>& a, const Color<T, N>& b) {
  return a.map(b, [&](const T& x, const T& y) { return select(m, x, y); });
}

/// The mean of the channels.
template <class T, int N> FACETA_INLINE T mean(const Color<T, N>& a) {
  T sum = a[0];
  for (int i = 1; i < N; ++i)
    sum = sum + a[i];
  return sum * T(1.0 / N);
}
template <class T, int N> FACETA_INLINE T max_component(const Color<T, N>& a) {
  T m = a[0];
  for (int i = 1; i < N; ++i)
    m = max(m, a[i]);
  return m;
}

} // namespace faceta
