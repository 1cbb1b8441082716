#pragma once

/// Arrays of directions through a material: what the command line, bindings and plots run.

#include "bsdf/registry.h"

#include <functional>

namespace faceta {

/// n pairs of directions (local frame, unit) with surface coordinates, and room for the results.
/// Every array is longer than n by kLanePadding.
struct EvalColumns {
  explicit EvalColumns(int n);
  /// Pointers into the arrays below, as kernels take them.
  EvalArrays arrays();

  int count;
  std::array<std::vector<float>, 3> wo, wi;
  std::array<std::vector<float>, 2> uv; ///< 0.5 at first
  std::array<std::vector<float>, 3> value;
  std::vector<float> pdf;
};

/// n directions with three uniform numbers in [0, 1) each, and room for the sampled directions.
/// Every array is longer than n by kLanePadding.
struct SampleColumns {
  explicit SampleColumns(int n);
  SampleArrays arrays();

  int count;
  std::array<std::vector<float>, 3> wo;
  std::array<std::vector<float>, 2> u;
  std::vector<float> uc;
  std::array<std::vector<float>, 2> uv; ///< 0.5 at first
  std::array<std::vector<float>, 3> wi, value, weight;
  std::vector<float> pdf, eta;
  std::vector<int32_t> flags; ///< lobe | kDeltaFlag | kValidFlag
};

/// A material ready to be run over arrays. Both functions may be called from several threads at
/// once. A single model gets them from column_material(); a scene's tree of materials has its own.
struct ColumnMaterial {
  std::function<void(EvalColumns&)> eval;
  std::function<void(SampleColumns&)> sample;
};

/// One parameter set of a model in an instruction set. Error if this CPU cannot run the set.
ColumnMaterial column_material(const Parameters& parameters, Isa isa = best_isa(),
                               TransportMode mode = TransportMode::radiance);

} // namespace faceta
