#pragma once

/// How a model describes itself. Each model has one function
///   template <class D> static void describe(D& d)
/// that names its parameters in order; D is one of several visitors: the descriptor builder below
/// (names, defaults, ranges, documentation) or the loaders of model.h, which ignore every text and
/// compile down to loads. The order of declaration is the order of the float slots in a record.

#include "bsdf/bsdf.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace faceta {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A closed interval.
struct Range {
  double low = -kInfinity, high = kInfinity;
};

/// A table that prepare_once() made: an offset per lane into the scene's arena.
template <class T> struct Table {
  const float* base = nullptr;
  IntOf<T> offset{0};

  FACETA_INLINE T at(const IntOf<T>& i) const { return gather<T>(base, offset + i); }
  /// From entry i (t = 0) to the next (t = 1).
  FACETA_INLINE T between(const IntOf<T>& i, const T& t) const {
    Neighbours<T> ends = gather_pair<T>(base, offset + i);
    return lerp(ends.first, ends.second, t);
  }
  /// Linear interpolation of `size` equidistant values over [0, 1].
  FACETA_INLINE T interpolate(const T& x, int size) const {
    T position = clamp01(x) * T(float(size - 1));
    T whole = min(floor(position), T(float(size - 2)));
    return between(to_int(whole), position - whole);
  }
};

/// What prepare_once() may use and make.
struct PrepareOnce {
  std::vector<float>& arena;
  std::vector<std::string> textured{}; ///< parameters that textures give, of which these are means

  bool has_texture(const std::string& parameter) const {
    return std::find(textured.begin(), textured.end(), parameter) != textured.end();
  }

  /// Appends a table to the arena.
  Table<double> add_table(const std::vector<double>& values) {
    Table<double> t;
    t.offset = static_cast<int32_t>(arena.size());
    for (double v : values)
      arena.push_back(static_cast<float>(v));
    t.base = arena.data();
    return t;
  }
};

enum class ParamKind {
  reflectance, ///< colour in [0, 1]; textures allowed
  spectrum,    ///< colour >= 0 without upper bound; textures allowed
  scalar,      ///< number; textures allowed
  number,      ///< number; no textures
  ior,         ///< index of refraction: a number or a name
  roughness,   ///< alpha for both directions; alpha_u and alpha_v follow as scalars of their own
  choice,      ///< one of several words
  flag,        ///< true or false
  metal,       ///< a named conductor, writes eta and k
  file         ///< a file of measured values (measured_table.h)
};

/// One parameter of a model, as everybody but the model sees it.
struct ParamInfo {
  std::string name, unit, doc;
  ParamKind kind = ParamKind::scalar;
  int slot = -1;   ///< first float slot (kinds with numbers)
  int slots = 0;   ///< how many: 3 for colours
  int choice = -1; ///< index into the integer choices (choice, flag)
  std::vector<std::string> choices;
  std::vector<double> defaults; ///< one per slot, or the choice
  std::string default_name;     ///< if the default has a name ("bk7", "none")
  Range hard, soft;             ///< outside hard: an error; soft: sliders, random tests
  bool textured = false;        ///< a texture may be bound
  std::string excludes; ///< comma-separated parameters that may not be given beside this one
  /// The scene contract clamps instead of refusing (alpha below 1e-4).
  bool clamps_low = false;
};

using Settings = std::vector<std::pair<std::string, std::string>>;

/// A named parameter set, for tests, galleries and documentation.
struct Exemplar {
  std::string name;
  Settings settings;
  bool lossless = false; ///< reflected plus transmitted energy is exactly 1
};

/// Why a property does not hold, and who says so: printed in every report.
struct Excuse {
  std::string property, reason;
  std::string reference{};
};

/// What a model becomes at the end of a range: with `settings` another one with `other`, in the
/// lobes that both have. What both call by the same name may have any value.
struct Limit {
  Settings settings;
  std::string model;
  Settings other;
  double tolerance; ///< of the energies; relative, of the values where neither has a delta lobe
};

/// Albedos that somebody else has computed, seen at cos theta = 1, 0.5 and 0.1.
struct KnownAlbedo {
  Settings settings;
  double albedo[3];
  double tolerance;
  std::string source;
};

struct Traits {
  uint32_t lobes = kReflection; ///< union of Lobe
  bool delta = false;           ///< every lobe is a delta
  bool has_delta = false;       ///< some lobe may be a delta
  bool reciprocal = true;       ///< f(wo, wi) = f(wi, wo), with eta^2 across an interface
  double albedo_bound = 1.0;    ///< largest albedo of any parameter set
  bool two_sided = false;       ///< scatters for wo below the surface as well
  bool of_angles = false;       ///< a function of angles, known to 2^-23 near the horizon too
};

/// The whole description of a model.
struct Descriptor {
  std::string name, title, equation;
  std::vector<std::string> references, notes;
  std::vector<ParamInfo> params;
  std::vector<Exemplar> exemplars;
  std::vector<Excuse> excuses;
  std::vector<Limit> limits;
  std::vector<KnownAlbedo> albedos;
  Traits traits;
  int slots = 0;                ///< floats per record, derived ones included
  int choices = 0;              ///< integers per record
  std::vector<int> table_slots; ///< slots that hold offsets into tables

  const ParamInfo* find(const std::string& param) const {
    for (const ParamInfo& p : params)
      if (p.name == param)
        return &p;
    return nullptr;
  }
  /// The slots that parameters give, each once: not derived ones, no tables.
  std::vector<int> parameter_slots() const {
    std::vector<int> list;
    for (const ParamInfo& p : params)
      for (int k = 0; p.slot >= 0 && k < p.slots; ++k)
        if (std::find(list.begin(), list.end(), p.slot + k) == list.end())
          list.push_back(p.slot + k);
    return list;
  }
  /// The parameter that names a file, or null.
  const ParamInfo* file() const {
    for (const ParamInfo& p : params)
      if (p.kind == ParamKind::file)
        return &p;
    return nullptr;
  }
  std::vector<std::string> param_names() const {
    std::vector<std::string> names;
    for (const ParamInfo& p : params)
      names.push_back(p.name);
    return names;
  }
};

/// The base of every visitor: ignores all that is only text.
template <class D> struct DescribeIgnoringTexts {
  FACETA_INLINE D& self() { return static_cast<D&>(*this); }
  FACETA_INLINE D& model(const char*, const char*) { return self(); }
  FACETA_INLINE D& equation(const char*) { return self(); }
  FACETA_INLINE D& reference(const char*) { return self(); }
  FACETA_INLINE D& note(const char*) { return self(); }
  FACETA_INLINE D& traits(const Traits&) { return self(); }
  FACETA_INLINE D& excuse(const char*, const char*, const char*) { return self(); }
  using Words = std::initializer_list<const char*>;
  using Pairs = std::initializer_list<std::pair<const char*, const char*>>;
  FACETA_INLINE D& exemplar(const char*, Pairs, bool = false) { return self(); }
  FACETA_INLINE D& limit(Pairs, const char*, Pairs, double) { return self(); }
  FACETA_INLINE D& known_albedo(Pairs, double, double, double, double, const char*) {
    return self();
  }
  FACETA_INLINE D& metal(const char*, const char*, const char*) { return self(); }
};

/// Builds the Descriptor of M (a model over double).
template <class M> class DescriptorBuilder : public DescribeIgnoringTexts<DescriptorBuilder<M>> {
public:
  using T = double;
  using Words = std::initializer_list<const char*>;
  using Pairs = std::initializer_list<std::pair<const char*, const char*>>;

  Descriptor descriptor;

  auto& model(const char* name, const char* title) {
    descriptor.name = name;
    descriptor.title = title;
    return *this;
  }
  auto& equation(const char* text) {
    descriptor.equation = text;
    return *this;
  }
  auto& reference(const char* text) {
    descriptor.references.push_back(text);
    return *this;
  }
  auto& note(const char* text) {
    descriptor.notes.push_back(text);
    return *this;
  }
  auto& traits(const Traits& t) {
    descriptor.traits = t;
    return *this;
  }
  auto& excuse(const char* property, const char* reason, const char* reference) {
    descriptor.excuses.push_back({property, reason, reference});
    return *this;
  }
  auto& exemplar(const char* name, Pairs settings, bool lossless = false) {
    descriptor.exemplars.push_back({name, to_settings(settings), lossless});
    return *this;
  }
  /// See Limit.
  auto& limit(Pairs settings, const char* model, Pairs other, double tolerance) {
    descriptor.limits.push_back({to_settings(settings), model, to_settings(other), tolerance});
    return *this;
  }
  /// See KnownAlbedo: at normal incidence, 60 degrees and 84 degrees (cos = 0.1).
  auto& known_albedo(Pairs settings, double normal, double slanted, double grazing,
                     double tolerance, const char* source) {
    descriptor.albedos.push_back(
        {to_settings(settings), {normal, slanted, grazing}, tolerance, source});
    return *this;
  }

  auto& reflectance(const char* name, Color<T> M::* field, const char* doc) {
    color(name, field, doc, ParamKind::reflectance, {0, 1}, {0, 1});
    return *this;
  }
  auto& spectrum(const char* name, Color<T> M::* field, Range soft, const char* doc) {
    color(name, field, doc, ParamKind::spectrum, {0, kInfinity}, soft);
    return *this;
  }
  auto& scalar(const char* name, T M::* field, Range hard, Range soft, const char* unit,
               const char* doc) {
    add(name, doc, ParamKind::scalar, {defaults_.*field}, hard, soft, unit, true);
    return *this;
  }
  auto& number(const char* name, T M::* field, Range hard, Range soft, const char* unit,
               const char* doc) {
    add(name, doc, ParamKind::number, {defaults_.*field}, hard, soft, unit, false);
    return *this;
  }
  auto& ior(const char* name, T M::* field, const char* default_name, const char* doc) {
    ParamInfo& p =
        add(name, doc, ParamKind::ior, {defaults_.*field}, {1e-6, kInfinity}, {1, 2.5}, "", false);
    p.default_name = default_name;
    return *this;
  }
  /// alpha | alpha_u, alpha_v: one texture or number for both directions, or one for each.
  auto& roughness(T M::* u, T M::* v, const char* doc) {
    ParamInfo& p = add("alpha", doc, ParamKind::roughness, {defaults_.*u, defaults_.*v},
                       {0, kInfinity}, {0.001, 1}, "RMS slope", true);
    p.excludes = "alpha_u,alpha_v";
    p.clamps_low = true;
    int first = p.slot;
    const char* names[] = {"alpha_u", "alpha_v"};
    const char* docs[] = {"roughness along the tangent (with alpha_v, instead of alpha)",
                          "roughness along the bitangent (with alpha_u, instead of alpha)"};
    for (int i = 0; i < 2; ++i) {
      ParamInfo alias = descriptor.params.back();
      if (i == 1)
        alias = *descriptor.find("alpha_u");
      alias.name = names[i];
      alias.doc = docs[i];
      alias.kind = ParamKind::scalar;
      alias.slot = first + i;
      alias.slots = 1;
      alias.defaults = {i == 0 ? defaults_.*u : defaults_.*v};
      alias.excludes = "alpha";
      descriptor.params.push_back(alias);
    }
    return *this;
  }
  auto& choice(const char* name, int M::* field, Words words, const char* doc) {
    ParamInfo p;
    p.name = name;
    p.doc = doc;
    p.kind = ParamKind::choice;
    p.choices.assign(words.begin(), words.end());
    p.defaults = {double(defaults_.*field)};
    p.choice = descriptor.choices++;
    descriptor.params.push_back(p);
    return *this;
  }
  auto& flag(const char* name, int M::* field, const char* doc) {
    choice(name, field, {"false", "true"}, doc);
    descriptor.params.back().kind = ParamKind::flag;
    return *this;
  }
  /// A parameter "material" that writes the two colours declared as "eta" and "k" before it.
  auto& metal(const char* name, const char* default_name, const char* doc) {
    ParamInfo p;
    p.name = name;
    p.doc = doc;
    p.kind = ParamKind::metal;
    p.default_name = default_name;
    p.excludes = "eta,k";
    descriptor.params.push_back(p);
    return *this;
  }
  /// A file that the parameters load (file_tables.h); one at most in a model, which has no tables of
  /// its own then.
  auto& file(const char* name, const float* M::*, const char* doc) {
    ParamInfo p;
    p.name = name;
    p.doc = doc;
    p.kind = ParamKind::file;
    descriptor.params.push_back(p);
    return *this;
  }
  auto& derived(T M::*) {
    ++descriptor.slots;
    return *this;
  }
  auto& derived(Color<T> M::*) {
    descriptor.slots += Color<T>::size();
    return *this;
  }
  auto& table(Table<T> M::*) {
    descriptor.table_slots.push_back(descriptor.slots++);
    return *this;
  }

private:
  static Settings to_settings(Pairs pairs) {
    Settings settings;
    for (auto& [key, value] : pairs)
      settings.emplace_back(key, value);
    return settings;
  }
  ParamInfo& add(const char* name, const char* doc, ParamKind kind, std::vector<double> defaults,
                 Range hard, Range soft, const char* unit, bool textured) {
    ParamInfo p;
    p.name = name;
    p.doc = doc;
    p.unit = unit;
    p.kind = kind;
    p.slot = descriptor.slots;
    p.slots = static_cast<int>(defaults.size());
    p.defaults = std::move(defaults);
    p.hard = hard;
    p.soft = soft;
    p.textured = textured;
    descriptor.slots += p.slots;
    descriptor.params.push_back(std::move(p));
    return descriptor.params.back();
  }
  void color(const char* name, Color<T> M::* field, const char* doc, ParamKind kind, Range hard,
             Range soft) {
    const Color<T>& c = defaults_.*field;
    add(name, doc, kind, {c[0], c[1], c[2]}, hard, soft, "", true);
  }

  M defaults_{};
};

} // namespace faceta
