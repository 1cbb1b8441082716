#pragma once

/// The properties that every registered model is held to, as functions of a model and its
/// parameters: the contract tests and `faceta verify` run the same ones.

#include "verify/subject.h"

#include <functional>

namespace faceta {

/// One property by name. Names appear in test names, reports and in a model's excuse().
struct Property {
  const char* name;
  const char* claim; ///< one sentence
  /// `level`: the probability of a false alarm that a statistical test may have.
  Outcome (*check)(const Subject&, Effort, double level);
  const char* figure = ""; ///< what Outcome::figure is; empty: it has none
};

/// Properties of a model with parameters.
const std::vector<Property>& subject_properties();

/// Properties of a model as a whole (its description, its parameters).
struct ModelProperty {
  const char* name;
  const char* claim;
  Outcome (*check)(const Model&);
};
const std::vector<ModelProperty>& model_properties();

/// The reason why a model or tree need not hold a property; null if it must.
const Excuse* find_excuse(const Descriptor& descriptor, const std::string& property);

// --- One function a property ---

/// Values, densities and weights are finite and not negative, whatever the directions (horizon,
/// grazing, wo = +-n, wi = wo, wi = -wo, h perpendicular to n) and random numbers; sampled
/// directions are unit vectors. Kernels and reference, both transport modes.
Outcome check_finite(const Subject&, Effort, double level);
/// Chi-square of >= 2^20 samples of the widest kernel against the reference's density integrated
/// over adaptive cells, delta lobes by their discrete probabilities. figure: the smallest p-value.
Outcome check_chi_square(const Subject&, Effort, double level);
/// Density integrated over the sphere plus discrete probabilities = 1 - share of failed samples.
/// figure: the largest difference.
Outcome check_density(const Subject&, Effort, double level);
/// weight = value / pdf; eval() at the sampled direction gives the sample's value and density; the
/// direction lies on the side that its lobe says. figure: the largest relative error.
Outcome check_consistency(const Subject&, Effort, double level);
/// The albedo is at most traits.albedo_bound at every angle; 1 to 1e-3 where the exemplar claims to
/// lose nothing (importance transport, which has no factor eta^2). A model with an excuse fails,
/// and is excused, as soon as it exceeds 1; above its bound nothing excuses it. figure: the largest
/// albedo.
Outcome check_energy(const Subject&, Effort, double level);
/// f(wo, wi) of radiance = f(wi, wo) of importance, if the traits claim it. figure: largest error.
Outcome check_reciprocity(const Subject&, Effort, double level);
/// The two transport modes differ by exactly eta^2 across an interface, and nowhere else.
Outcome check_modes(const Subject&, Effort, double level);
/// Kernels of every instruction set give the scalar module's bits: one material, a material of its
/// own in each lane, textures on every textured parameter; eval, sample and both together.
Outcome check_lanes(const Subject&, Effort, double level);
/// The float kernels agree with the double reference to 1e-5 beyond what one unit in the last place
/// of any input moves the reference; values and densities below 3e-10 are black. figure: the
/// largest error over what is allowed.
Outcome check_precision(const Subject&, Effort, double level);
/// Jet derivatives agree with central differences to 1e-6 away from kinks. figure: largest error.
Outcome check_derivatives(const Subject&, Effort, double level);
/// Over colours of six channels (the record's three twice) every channel has the value and all have
/// the density that three channels give, samples likewise. figure: the largest error over what is
/// allowed.
Outcome check_channels(const Subject&, Effort, double level);
/// Parameters survive being written as text and read back: same numbers, same choices, same names.
Outcome check_round_trip(const Subject&, Effort, double level);

/// Names, texts, references and exemplars are there; excuses name properties; defaults lie in
/// range.
Outcome check_description(const Model&);
/// Outside its hard range a parameter is refused by a message that names it; inside, it changes a
/// value, a density or a sample somewhere.
Outcome check_parameters(const Model&);

/// Each textured parameter of each exemplar by itself, with values that alternate from lane to
/// lane: every lane gives what the material with that value gives (bits; 1e-5 where the model keeps
/// derived numbers, 5 % and 3e-3 where it keeps a table made for the texture's mean), and the
/// values make a difference.
Outcome check_textures(const Model&);
/// With the settings of each of the descriptor's limits the model scatters the energy of the other
/// model, into the same directions on the whole, lobe by lobe (at evenly spread points; both
/// transport modes, both sides); values agree where neither has delta lobes. The parameters that
/// both have, and the choices of either, are drawn at random. Interfaces between equal indices let
/// light pass as if nothing were there, or refuse to be. figure: the largest error over what is
/// allowed.
Outcome check_limits(const Model&);
/// The descriptor's known albedos, at evenly spread points. figure: the largest difference.
Outcome check_albedos(const Model&);

/// Writes parameters in some format and reads them back.
using RoundTrip = std::function<Parameters(const Parameters&)>;
/// The formats that check_round_trip() goes through; text is there from the start, a program that
/// links more formats adds them before it runs the properties.
std::vector<std::pair<std::string, RoundTrip>>& round_trips();
/// The same for trees of materials; none from the start.
using TreeRoundTrip = std::function<std::shared_ptr<MaterialNode>(const MaterialNode&)>;
std::vector<std::pair<std::string, TreeRoundTrip>>& tree_round_trips();

} // namespace faceta
