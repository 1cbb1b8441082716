#pragma once

/// Arrays in the layout that the kernels of a material read and write, with the padding they need.

#include "bsdf/registry.h"
#include "verify/random_stream.h"

#include <vector>

namespace faceta {

/// n queries of eval.
struct EvalBatch {
  int n = 0;
  std::vector<float> wo[3], wi[3], value[3], pdf;

  explicit EvalBatch(int count);
  void set(int i, const Vec3<float>& o, const Vec3<float>& in);
  Vec3<float> viewer(int i) const { return {wo[0][i], wo[1][i], wo[2][i]}; }
  Vec3<float> light(int i) const { return {wi[0][i], wi[1][i], wi[2][i]}; }
  EvalArrays arrays();
  /// A model's kernel; Subject::run() runs subjects of every kind.
  void run(const MaterialKernel& kernel, const MaterialArgs& args);
};

/// n queries of sample.
struct SampleBatch {
  int n = 0;
  std::vector<float> wo[3], u[2], uc, wi[3], value[3], pdf, weight[3], eta;
  std::vector<int32_t> flags;

  explicit SampleBatch(int count);
  void set_viewer(int i, const Vec3<float>& o);
  void set_all_viewers(const Vec3<float>& o);
  /// Fresh uniform numbers for every query.
  void draw(RandomStream& random);
  bool valid(int i) const { return (flags[i] & kValidFlag) != 0; }
  bool delta(int i) const { return (flags[i] & kDeltaFlag) != 0; }
  int lobe(int i) const { return flags[i] & kLobeMask; }
  Vec3<float> viewer(int i) const { return {wo[0][i], wo[1][i], wo[2][i]}; }
  Vec3<float> light(int i) const { return {wi[0][i], wi[1][i], wi[2][i]}; }
  SampleArrays arrays();
  void run(const MaterialKernel& kernel, const MaterialArgs& args);
};

inline Vec3<double> to_double(const Vec3<float>& v) {
  return {v.x, v.y, v.z};
}
inline Vec3<float> to_single(const Vec3<double>& v) {
  return {float(v.x), float(v.y), float(v.z)};
}

} // namespace faceta
