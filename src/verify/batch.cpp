#include "verify/batch.h"

#include <algorithm>

namespace faceta {

EvalBatch::EvalBatch(int count) : n(count) {
  for (int k = 0; k < 3; ++k)
    for (auto* a : {&wo[k], &wi[k], &value[k]})
      a->assign(n + kLanePadding, 0.0f);
  pdf.assign(n + kLanePadding, 0.0f);
}

void EvalBatch::set(int i, const Vec3<float>& o, const Vec3<float>& in) {
  wo[0][i] = o.x, wo[1][i] = o.y, wo[2][i] = o.z;
  wi[0][i] = in.x, wi[1][i] = in.y, wi[2][i] = in.z;
}

EvalArrays EvalBatch::arrays() {
  EvalArrays a{};
  for (int k = 0; k < 3; ++k) {
    a.wo[k] = wo[k].data();
    a.wi[k] = wi[k].data();
    a.value[k] = value[k].data();
  }
  a.pdf = pdf.data();
  return a;
}

void EvalBatch::run(const MaterialKernel& kernel, const MaterialArgs& args) {
  kernel.eval(args, arrays(), n);
}

SampleBatch::SampleBatch(int count) : n(count) {
  for (int k = 0; k < 3; ++k)
    for (auto* a : {&wo[k], &wi[k], &value[k], &weight[k]})
      a->assign(n + kLanePadding, 0.0f);
  for (auto* a : {&u[0], &u[1], &uc, &pdf, &eta})
    a->assign(n + kLanePadding, 0.0f);
  flags.assign(n + kLanePadding, 0);
}

void SampleBatch::set_viewer(int i, const Vec3<float>& o) {
  wo[0][i] = o.x, wo[1][i] = o.y, wo[2][i] = o.z;
}

void SampleBatch::set_all_viewers(const Vec3<float>& o) {
  std::fill(wo[0].begin(), wo[0].end(), o.x);
  std::fill(wo[1].begin(), wo[1].end(), o.y);
  std::fill(wo[2].begin(), wo[2].end(), o.z);
}

void SampleBatch::draw(RandomStream& random) {
  for (int i = 0; i < n; ++i) {
    u[0][i] = random.next_float();
    u[1][i] = random.next_float();
    uc[i] = random.next_float();
  }
}

SampleArrays SampleBatch::arrays() {
  SampleArrays a{};
  for (int k = 0; k < 3; ++k) {
    a.wo[k] = wo[k].data();
    a.wi[k] = wi[k].data();
    a.value[k] = value[k].data();
    a.weight[k] = weight[k].data();
  }
  a.u[0] = u[0].data();
  a.u[1] = u[1].data();
  a.uc = uc.data();
  a.pdf = pdf.data();
  a.eta = eta.data();
  a.flags = flags.data();
  return a;
}

void SampleBatch::run(const MaterialKernel& kernel, const MaterialArgs& args) {
  kernel.sample(args, arrays(), n);
}

} // namespace faceta
