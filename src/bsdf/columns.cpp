#include "bsdf/columns.h"

namespace faceta {

namespace {

template <size_t n> void fill(std::array<std::vector<float>, n>& arrays, size_t size, float value) {
  for (std::vector<float>& array : arrays)
    array.assign(size, value);
}

size_t padded(int n) {
  return static_cast<size_t>(n) + kLanePadding;
}

/// The kernels of the CPUs that cannot run them are not even loaded.
const MaterialKernel& kernel_of(const Model& model, Isa isa) {
  const MaterialKernel* kernel = model.kernels[static_cast<int>(isa)];
  if (!kernel)
    throw Error(std::string("this CPU cannot run the instruction set '") +
                    kIsaNames[static_cast<int>(isa)] + "'",
                {},
                std::string("the best it can run is ") + kIsaNames[static_cast<int>(best_isa())]);
  return *kernel;
}

} // namespace

EvalColumns::EvalColumns(int n) : count(n) {
  fill(wo, padded(n), 0);
  fill(wi, padded(n), 0);
  fill(uv, padded(n), 0.5f);
  fill(value, padded(n), 0);
  pdf.assign(padded(n), 0);
}

EvalArrays EvalColumns::arrays() {
  return {{wo[0].data(), wo[1].data(), wo[2].data()},
          {wi[0].data(), wi[1].data(), wi[2].data()},
          {uv[0].data(), uv[1].data()},
          {value[0].data(), value[1].data(), value[2].data()},
          pdf.data()};
}

SampleColumns::SampleColumns(int n) : count(n) {
  fill(wo, padded(n), 0);
  fill(u, padded(n), 0);
  uc.assign(padded(n), 0);
  fill(uv, padded(n), 0.5f);
  fill(wi, padded(n), 0);
  fill(value, padded(n), 0);
  fill(weight, padded(n), 0);
  pdf.assign(padded(n), 0);
  eta.assign(padded(n), 1);
  flags.assign(padded(n), 0);
}

SampleArrays SampleColumns::arrays() {
  SampleArrays a{};
  for (int i = 0; i < 3; ++i) {
    a.wo[i] = wo[i].data();
    a.wi[i] = wi[i].data();
    a.value[i] = value[i].data();
    a.weight[i] = weight[i].data();
  }
  for (int i = 0; i < 2; ++i) {
    a.u[i] = u[i].data();
    a.uv[i] = uv[i].data();
  }
  a.uc = uc.data();
  a.pdf = pdf.data();
  a.eta = eta.data();
  a.flags = flags.data();
  return a;
}

ColumnMaterial column_material(const Parameters& parameters, Isa isa, TransportMode mode) {
  parameters.check();
  const MaterialKernel* kernel = &kernel_of(parameters.model(), isa);
  auto record = std::make_shared<const Record>(parameters.record());
  return {[=](EvalColumns& b) { kernel->eval(record->args(mode), b.arrays(), b.count); },
          [=](SampleColumns& b) { kernel->sample(record->args(mode), b.arrays(), b.count); }};
}

} // namespace faceta
