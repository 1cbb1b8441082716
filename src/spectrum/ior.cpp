#include "spectrum/ior.h"

#include <span>

namespace faceta {
namespace {

struct MetalEntry {
  std::string_view name;
  std::span<const double> rows;
};

#include "spectrum/data/metals.inc"

/// A row of the course's table of conductors.
struct NamedConductor {
  std::string_view english, spanish;
  std::array<double, 3> eta, k;
};

constexpr NamedConductor kCourseConductors[] = {
    {"aluminium", "aluminio", {1.66058, 0.88143, 0.521467}, {9.2282, 6.27077, 4.83803}},
    {"copper", "cobre", {0.208183, 0.919438, 1.10241}, {3.92198, 2.45627, 2.14157}},
    {"chromium", "cromo", {4.48917, 2.90664, 1.66205}, {5.21625, 4.22766, 3.75206}},
    {"lithium", "litio", {0.269479, 0.20043, 0.22334}, {3.54258, 2.35127, 1.68649}},
    {"mercury", "mercurio", {2.42685, 1.45639, 0.914464}, {6.34596, 4.39272, 3.42653}},
    {"gold", "oro", {0.143245, 0.377423, 1.43919}, {3.98479, 2.3847, 1.60434}},
    {"silver", "plata", {0.15554, 0.11678, 0.138371}, {4.83139, 3.12331, 2.14745}},
    {"tungsten", "tungsteno", {4.37329, 3.3001, 2.99905}, {3.50037, 2.60519, 2.2736}},
};

struct NamedDielectric {
  std::string_view name;
  double eta;
};

constexpr NamedDielectric kDielectrics[] = {
    // The scene contract's.
    {"vacuum", 1},
    {"helium", 1.000036},
    {"hydrogen", 1.000132},
    {"air", 1.000277},
    {"carbon dioxide", 1.00045},
    {"water", 1.333},
    {"acetone", 1.36},
    {"ethanol", 1.361},
    {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729},
    {"benzene", 1.501},
    {"silicone oil", 1.52045},
    {"bromine", 1.661},
    {"water ice", 1.31},
    {"fused quartz", 1.458},
    {"pyrex", 1.47},
    {"acrylic glass", 1.49},
    {"polypropylene", 1.49},
    {"bk7", 1.5046},
    {"sodium chloride", 1.544},
    {"amber", 1.55},
    {"pet", 1.575},
    {"diamond", 2.419},
    // The course's; glass is the lower end of its 1.5 to 1.6.
    {"ice", 1.31},
    {"quartz", 1.46},
    {"glass", 1.5},
    {"sapphire", 1.77},
    {"vacío", 1},
    {"aire", 1.00029},
    {"hielo", 1.31},
    {"agua", 1.333},
    {"cuarzo", 1.46},
    {"cristal", 1.5},
    {"zafiro", 1.77},
    {"diamante", 2.42},
};

/// Lower case of ASCII letters, the accented i of UTF-8 (composed or not) without its accent.
std::string folded(std::string_view name) {
  std::string result;
  for (size_t i = 0; i < name.size(); ++i) {
    std::string_view pair = name.substr(i, 2);
    if (pair == "\xc3\xad" || pair == "\xc3\x8d") {
      result += 'i';
      ++i;
    } else if (pair == "\xcc\x81" && result.ends_with('i')) {
      ++i;
    } else {
      char c = name[i];
      result += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
  return result;
}

} // namespace

std::optional<ConductorSpectrum> find_conductor_spectrum(std::string_view name) {
  for (const MetalEntry& metal : kMetals) {
    if (metal.name != name)
      continue;
    ConductorSpectrum result;
    result.name = metal.name;
    for (size_t i = 0; i + 2 < metal.rows.size(); i += 3) {
      result.eta.wavelengths.push_back(metal.rows[i]);
      result.eta.values.push_back(metal.rows[i + 1]);
      result.k.values.push_back(metal.rows[i + 2]);
    }
    result.k.wavelengths = result.eta.wavelengths;
    return result;
  }
  return std::nullopt;
}

std::optional<ConductorIor> find_conductor(std::string_view name) {
  if (name == "none")
    return ConductorIor{"none", {0, 0, 0}, {1, 1, 1}};
  if (auto metal = find_conductor_spectrum(name))
    return ConductorIor{metal->name, spectrum_to_rgb(metal->eta, SpectrumUse::refractive_index),
                        spectrum_to_rgb(metal->k, SpectrumUse::refractive_index)};
  std::string key = folded(name);
  for (const NamedConductor& row : kCourseConductors)
    if (key == row.english || key == row.spanish)
      return ConductorIor{std::string(row.english), row.eta, row.k};
  return std::nullopt;
}

std::vector<std::string> conductor_names() {
  std::vector<std::string> names{"none"};
  for (const NamedConductor& row : kCourseConductors)
    names.emplace_back(row.english);
  for (const NamedConductor& row : kCourseConductors)
    names.emplace_back(row.spanish);
  for (const MetalEntry& metal : kMetals)
    names.emplace_back(metal.name);
  return names;
}

std::optional<double> find_dielectric(std::string_view name) {
  std::string key = folded(name);
  for (const NamedDielectric& entry : kDielectrics)
    if (key == folded(entry.name))
      return entry.eta;
  return std::nullopt;
}

std::vector<std::string> dielectric_names() {
  std::vector<std::string> names;
  for (const NamedDielectric& entry : kDielectrics)
    names.emplace_back(entry.name);
  return names;
}

} // namespace faceta
