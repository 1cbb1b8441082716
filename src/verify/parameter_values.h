#pragma once

/// Values for a model's parameters that go together: what properties try out.

#include "bsdf/registry.h"

namespace faceta {

/// What must be given together with a parameter (alpha_v with alpha_u, k with eta); empty: nothing.
std::string partner_of(const std::string& name);

/// Whether a comma-separated list, such as ParamInfo::excludes, holds a name.
bool lists(const std::string& comma_separated, const std::string& name);

/// A number in the soft range, at a share u in [0, 1] of it.
double soft_value(const ParamInfo& p, double u);

/// An exemplar with one parameter changed to `text`, without what the change excludes.
/// @throws Error if the model refuses it.
Parameters changed(const Model& model, const Exemplar& exemplar, const ParamInfo& p,
                   const std::string& text);

} // namespace faceta
