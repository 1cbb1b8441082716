#pragma once

/// A material seen as a function of two directions, in double precision: what audits and
/// conversions work on, be it a model or a file.

#include "bsdf/measured_data.h"
#include "bsdf/registry.h"
#include "sampling/even_point.h"

namespace faceta {

/// What a material reflects to the front, at the centre of its textures.
class Reflector {
public:
  /// Error if the material has delta lobes, which no table can hold, or reflects nothing; or as of
  /// Parameters::record().
  explicit Reflector(const Parameters& material);
  /// The table of a file, sampled as the renderer does it. `name` is for errors.
  Reflector(const MeasuredFile& file, const std::string& name);

  /// f_r |cos theta_i|; both directions above the surface.
  Color<double> value(const Vec3<double>& wo, const Vec3<double>& wi) const {
    return model_->eval(record_, {wo, wi}).value;
  }
  Sample<double> sample(const Vec3<double>& wo, const Random<double>& random) const {
    return model_->sample(record_, wo, random, TransportMode::radiance, {0.5, 0.5});
  }
  /// Of sample().
  double density(const Vec3<double>& wo, const Vec3<double>& wi) const {
    return model_->eval(record_, {wo, wi}).pdf;
  }
  /// Whether light also goes through the surface: that is left out.
  bool transmits() const { return (model_->descriptor.traits.lobes & kTransmission) != 0; }

private:
  const Model* model_;
  Record record_;
};

/// A model by its name with parameters, or a file of measured reflectance (or demonstration) with
/// those of the model `measured`. Error as of Parameters and Reflector, or if there is neither.
Reflector find_reflector(const std::string& name, const Settings& settings);

/// The sum of a function over a reflector's own samples, over their number: what a viewer gets
/// (n evenly spread samples; function(wi, pdf) is called for those above the surface).
template <class F>
void for_samples(const Reflector& reflector, const Vec3<double>& wo, int n, const F& function) {
  for (int k = 0; k < n; ++k) {
    Vec3<double> e = even_point(k);
    Sample<double> s = reflector.sample(wo, {{e.x, e.y}, e.z});
    if (s.valid && s.pdf > 0 && s.wi.z > 0)
      function(s.wi, s.pdf);
  }
}

/// Directional albedo: the share of light from all around that reaches the viewer, by n samples.
std::array<double, 3> albedo(const Reflector& reflector, const Vec3<double>& wo, int n = 4096);

/// The direction of these angles.
Vec3<double> direction_of(double theta, double phi);

} // namespace faceta
