#include "spectrum/ior.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

using namespace faceta;
using Triple = std::array<double, 3>;

namespace {

struct Conductor {
  const char* name;
  Triple eta, k;
};

const Conductor kMitsuba[] = {
#include "mitsuba_metals.inc"
};

double relative_difference(const Triple& a, const Triple& b) {
  double difference = 0, scale = 0;
  for (size_t c = 0; c < 3; ++c) {
    difference = std::max(difference, std::abs(a[c] - b[c]));
    scale = std::max(scale, std::abs(b[c]));
  }
  return scale > 0 ? difference / scale : difference;
}

} // namespace

TEST(Conductors, All71AgreeWithMitsuba) {
  EXPECT_EQ(std::size(kMitsuba), 71u);
  for (const Conductor& want : kMitsuba) {
    SCOPED_TRACE(want.name);
    auto got = find_conductor(want.name);
    ASSERT_TRUE(got);
    EXPECT_EQ(got->name, want.name);
    EXPECT_LT(relative_difference(got->eta, want.eta), 2e-6);
    EXPECT_LT(relative_difference(got->k, want.k), 2e-6);
  }
}

TEST(Conductors, NoneIsThePerfectMirror) {
  auto none = find_conductor("none");
  ASSERT_TRUE(none);
  EXPECT_EQ(none->name, "none");
  EXPECT_EQ(none->eta, (Triple{0, 0, 0}));
  EXPECT_EQ(none->k, (Triple{1, 1, 1}));
}

TEST(Conductors, CourseRowsInBothLanguages) {
  struct Row {
    const char *english, *spanish;
    Triple eta, k;
  };
  const Row rows[] = {
      {"aluminium", "aluminio", {1.66058, 0.88143, 0.521467}, {9.2282, 6.27077, 4.83803}},
      {"copper", "cobre", {0.208183, 0.919438, 1.10241}, {3.92198, 2.45627, 2.14157}},
      {"chromium", "cromo", {4.48917, 2.90664, 1.66205}, {5.21625, 4.22766, 3.75206}},
      {"lithium", "litio", {0.269479, 0.20043, 0.22334}, {3.54258, 2.35127, 1.68649}},
      {"mercury", "mercurio", {2.42685, 1.45639, 0.914464}, {6.34596, 4.39272, 3.42653}},
      {"gold", "oro", {0.143245, 0.377423, 1.43919}, {3.98479, 2.3847, 1.60434}},
      {"silver", "plata", {0.15554, 0.11678, 0.138371}, {4.83139, 3.12331, 2.14745}},
      {"tungsten", "tungsteno", {4.37329, 3.3001, 2.99905}, {3.50037, 2.60519, 2.2736}},
  };
  for (const Row& row : rows)
    for (std::string name : {row.english, row.spanish}) {
      std::string upper = name;
      for (char& c : upper)
        c = static_cast<char>(std::toupper(c));
      for (const std::string& spelling : {name, upper}) {
        auto got = find_conductor(spelling);
        ASSERT_TRUE(got) << spelling;
        EXPECT_EQ(got->name, row.english);
        EXPECT_EQ(got->eta, row.eta);
        EXPECT_EQ(got->k, row.k);
      }
    }
}

TEST(Conductors, CourseRowsLieNearTheSpectralTables) {
  // Two integrations of the same measurements: a swapped row or column would be far off.
  const std::pair<const char*, const char*> pairs[] = {
      {"aluminium", "Al"}, {"copper", "Cu"}, {"chromium", "Cr"}, {"lithium", "Li"},
      {"mercury", "Hg"},   {"gold", "Au"},   {"silver", "Ag"},   {"tungsten", "W"}};
  for (auto [course, spectral] : pairs) {
    auto a = find_conductor(course), b = find_conductor(spectral);
    ASSERT_TRUE(a && b);
    EXPECT_LT(relative_difference(a->eta, b->eta), 0.03) << course;
    EXPECT_LT(relative_difference(a->k, b->k), 0.03) << course;
    EXPECT_NE(a->eta, b->eta);
  }
}

TEST(Conductors, ContractNamesAreCaseSensitive) {
  for (const char* name : {"au", "AU", "cu_palik", "None", "NONE", "", "Au ", "unobtainium"})
    EXPECT_FALSE(find_conductor(name)) << name;
}

TEST(Conductors, TablesAreValidAndListed) {
  std::vector<std::string> names = conductor_names();
  EXPECT_EQ(names.size(), 71u + 1 + 16);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (const std::string& name : names)
    EXPECT_TRUE(find_conductor(name)) << name;
  for (const Conductor& metal : kMitsuba) {
    auto table = find_conductor_spectrum(metal.name);
    ASSERT_TRUE(table) << metal.name;
    EXPECT_NO_THROW(check_spectrum(table->eta));
    EXPECT_NO_THROW(check_spectrum(table->k));
    EXPECT_EQ(table->eta.wavelengths, table->k.wavelengths);
    EXPECT_GE(*std::min_element(table->eta.values.begin(), table->eta.values.end()), 0);
    EXPECT_GE(*std::min_element(table->k.values.begin(), table->k.values.end()), 0);
  }
  EXPECT_FALSE(find_conductor_spectrum("gold"));
  EXPECT_FALSE(find_conductor_spectrum("none"));
}

TEST(Dielectrics, ContractNames) {
  // Origin: Mitsuba 3.9.1, eta of a dielectric with this int_ior against ext_ior 1 (in float).
  const std::pair<const char*, float> rows[] = {
      {"vacuum", 1.0f},
      {"helium", 1.0000360012054443f},
      {"hydrogen", 1.0001319646835327f},
      {"air", 1.000277042388916f},
      {"carbon dioxide", 1.0004500150680542f},
      {"water", 1.3329999446868896f},
      {"acetone", 1.3600000143051147f},
      {"ethanol", 1.3609999418258667f},
      {"carbon tetrachloride", 1.4609999656677246f},
      {"glycerol", 1.4729000329971313f},
      {"benzene", 1.5010000467300415f},
      {"silicone oil", 1.5204499959945679f},
      {"bromine", 1.6610000133514404f},
      {"water ice", 1.309999942779541f},
      {"fused quartz", 1.4579999446868896f},
      {"pyrex", 1.4700000286102295f},
      {"acrylic glass", 1.4900000095367432f},
      {"polypropylene", 1.4900000095367432f},
      {"bk7", 1.5046000480651855f},
      {"sodium chloride", 1.5440000295639038f},
      {"amber", 1.5499999523162842f},
      {"pet", 1.5750000476837158f},
      {"diamond", 2.4189999103546143f},
  };
  EXPECT_EQ(std::size(rows), 23u);
  for (auto [name, eta] : rows) {
    ASSERT_TRUE(find_dielectric(name)) << name;
    EXPECT_EQ(static_cast<float>(*find_dielectric(name)), eta) << name;
  }
  EXPECT_EQ(find_dielectric("BK7"), 1.5046);
  EXPECT_EQ(find_dielectric("Water Ice"), 1.31);
}

TEST(Dielectrics, CourseNamesInBothLanguages) {
  const std::pair<const char*, double> rows[] = {
      {"ice", 1.31},   {"quartz", 1.46},  {"glass", 1.5},     {"sapphire", 1.77}, {"vacío", 1},
      {"vacio", 1},    {"VACÍO", 1},      {"vaci\u0301o", 1}, {"VACIO", 1},       {"aire", 1.00029},
      {"hielo", 1.31}, {"agua", 1.333},   {"cuarzo", 1.46},   {"cristal", 1.5},   {"zafiro", 1.77},
      {"Hielo", 1.31}, {"diamante", 2.42}};
  for (auto [name, eta] : rows)
    EXPECT_EQ(find_dielectric(name), eta) << name;
  for (const char* name : {"", "unobtainium", "water_ice", "vac", "\xc3"})
    EXPECT_FALSE(find_dielectric(name)) << name;
  std::vector<std::string> names = dielectric_names();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (const std::string& name : names)
    EXPECT_TRUE(find_dielectric(name)) << name;
}
