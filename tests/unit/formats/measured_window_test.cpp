#include "measured_checks.h"

#include <fmt/format.h>
#include <fstream>

using namespace faceta;
using namespace faceta::test;

namespace {

struct Cell {
  int ring, index, cells;
};

Cell cell_of(const KlemsBasis& basis, int number) {
  int ring = 0;
  while (number >= basis.cells[ring])
    number -= basis.cells[ring++];
  return {ring, number, basis.cells[ring]};
}

/// The integral of cos theta over a cell.
double projected_solid_angle(const KlemsBasis& basis, int number) {
  Cell c = cell_of(basis, number);
  double a = std::cos(basis.theta[c.ring]), b = std::cos(basis.theta[c.ring + 1]);
  return kPi * (a * a - b * b) / c.cells;
}

/// What leaves to anywhere of the light of a cell.
double hemispherical(const MeasuredPatches& patches, MeasuredPass pass, int in) {
  int n = patches.outgoing.size();
  double sum = 0;
  for (int o = 0; o < n; ++o)
    sum += projected_solid_angle(patches.outgoing, o) *
           patches.rgb[pass][3 * (static_cast<size_t>(in) * n + o)];
  return sum;
}

/// The light's cell that the file calls `number`: half a turn on.
int turned(const KlemsBasis& basis, int number) {
  Cell c = cell_of(basis, number);
  return number - c.index + (c.index + c.cells / 2) % c.cells;
}

std::string document(const std::string& structure, const std::string& data,
                     const std::string& basis = "") {
  return "<?xml version=\"1.0\"?>\n<WindowElement>\n<Optical><Layer>\n<Material><Name>cloth</Name>"
         "</Material>\n<DataDefinition><IncidentDataStructure>" +
         structure + "</IncidentDataStructure>" + basis + "</DataDefinition>\n" + data +
         "</Layer></Optical>\n</WindowElement>\n";
}

std::string block(const std::string& wavelength, const std::string& direction,
                  const std::string& bases, const std::string& values) {
  return "<WavelengthData><Wavelength unit=\"Integral\">" + wavelength +
         "</Wavelength><WavelengthDataBlock><WavelengthDataDirection>" + direction +
         "</WavelengthDataDirection>" + bases + "<ScatteringData>" + values +
         "</ScatteringData></WavelengthDataBlock></WavelengthData>\n";
}

std::string klems(const std::string& name) {
  return "<ColumnAngleBasis>LBNL/Klems " + name + "</ColumnAngleBasis><RowAngleBasis>LBNL/Klems " +
         name + "</RowAngleBasis>";
}

constexpr const char* kTree = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";

/// Shirley and Chiu 1997, from the disk to the square.
std::array<double, 2> disk_to_square(double x, double y) {
  double r = std::hypot(x, y), phi = std::atan2(y, x);
  phi += phi < -kPi / 4 ? 2 * kPi : 0;
  double a = 0, b = 0;
  if (phi < kPi / 4) {
    a = r;
    b = phi * r / (kPi / 4);
  } else if (phi < 3 * kPi / 4) {
    b = r;
    a = -(phi - kPi / 2) * r / (kPi / 4);
  } else if (phi < 5 * kPi / 4) {
    a = -r;
    b = (phi - kPi) * -r / (kPi / 4);
  } else {
    b = -r;
    a = (phi - 3 * kPi / 2) * r / (kPi / 4);
  }
  return {(a + 1) / 2, (b + 1) / 2};
}

float tree_value(const MeasuredTree& tree, MeasuredPass pass, std::vector<double> position) {
  int32_t node = tree.nodes[pass][0];
  while (node >= 0) {
    int child = 0;
    for (size_t d = 0; d < position.size(); ++d) {
      position[d] *= 2;
      int bit = position[d] >= 1;
      child |= bit << d;
      position[d] -= bit;
    }
    node = tree.nodes[pass][static_cast<size_t>(node + child)];
  }
  return tree.rgb[pass][3 * static_cast<size_t>(-1 - node)];
}

} // namespace

TEST(MeasuredKlems, real_files_integrate_to_what_python_integrates) {
  struct Row {
    MeasuredPass pass;
    double in0, in5, in100;
  };
  struct File {
    const char* name;
    std::vector<Row> rows;
  };
  // sums of the numbers in the files times the solid angles, by a script of numpy
  const File files[] = {
      {"2011-SA1.XML",
       {{kBackTransmission, 0.09587367289757788, 0.09387795773102166, 0.08472175072784865},
        {kFrontTransmission, 0.0943210439911208, 0.09180742658790009, 0.05452666168817395},
        {kBackReflection, 0.48245752540443826, 0.48451841018519287, 0.5591249525226436},
        {kFrontReflection, 0.5600014568729952, 0.5619461027255669, 0.6324528666500827}}},
      {"aerc6216_kf.xml",
       {{kFrontReflection, 0.15572018515648434, 0.1560966754484006, 0.18165770019426328},
        {kFrontTransmission, 0.06529694870863395, 0.06612952538722262, 0.028186947609760413},
        {kBackTransmission, 0.05677550203348962, 0.05211766463862143, 0.03665896633711532}}}};
  for (const File& file : files) {
    std::string path = real_file(std::string("radiance-xml/") + file.name);
    if (path.empty())
      GTEST_SKIP() << "the Window files are not there";
    MeasuredFile read = read_measured(path);
    const auto& patches = std::get<MeasuredPatches>(read.data);
    ASSERT_EQ(patches.incident.size(), 145);
    double all = 0;
    for (int i = 0; i < 145; ++i)
      all += projected_solid_angle(patches.outgoing, i);
    EXPECT_NEAR(all, kPi, 1e-12);
    for (const Row& row : file.rows) {
      EXPECT_NEAR(hemispherical(patches, row.pass, 0), row.in0, 1e-6);
      EXPECT_NEAR(hemispherical(patches, row.pass, turned(patches.incident, 5)), row.in5, 1e-6);
      EXPECT_NEAR(hemispherical(patches, row.pass, turned(patches.incident, 100)), row.in100, 1e-6);
    }
    EXPECT_EQ(read.info.format, "klems");
    EXPECT_EQ(read.info.cells, 145 * 145 * static_cast<int64_t>(file.rows.size()));
  }
}

TEST(MeasuredKlems, light_that_goes_straight_through_leaves_opposite_to_where_it_came_from) {
  std::string path = real_file("radiance-xml/2011-SA1.XML");
  if (path.empty())
    GTEST_SKIP() << "the Window files are not there";
  MeasuredFile read = read_measured(path);
  const auto& patches = std::get<MeasuredPatches>(read.data);
  // the holes of the fabric: up to 45 degrees the cell straight on is the brightest by far
  for (int in = 1; in < 69; ++in) {
    const float* row = &patches.rgb[kBackTransmission][3 * static_cast<size_t>(in) * 145];
    int brightest = 0;
    for (int o = 0; o < 145; ++o)
      if (row[3 * o] > row[3 * brightest])
        brightest = o;
    EXPECT_EQ(brightest, turned(patches.incident, in));
  }
  EXPECT_NE(read.info.description.find("Satine"), std::string::npos);
}

TEST(MeasuredKlems, columns_rows_and_colours) {
  // a quarter basis; the value tells its cells
  std::string columns, rows, x, z;
  for (int a = 0; a < 41; ++a)
    for (int b = 0; b < 41; ++b) {
      columns += fmt::format("{},\t", 1000 + 41 * b + a); // [outgoing a][incident b]
      rows += fmt::format("{}\n", 1000 + 41 * a + b);     // [incident a][outgoing b]
      x += "0.950456 ";
      z += "1.089058 ";
    }
  for (bool by_rows : {false, true}) {
    MeasuredFile file = parse_measured(
        document(by_rows ? "Rows" : "Columns",
                 block("Visible", "Reflection Back", klems("Quarter"), by_rows ? rows : columns)),
        "k.xml");
    const auto& patches = std::get<MeasuredPatches>(file.data);
    ASSERT_EQ(patches.incident.size(), 41);
    EXPECT_TRUE(patches.rgb[kBackReflection].empty());
    for (int i = 0; i < 41; ++i)
      for (int o = 0; o < 41; ++o)
        ASSERT_EQ(patches.rgb[kFrontReflection]
                             [3 * static_cast<size_t>(turned(patches.incident, i) * 41 + o)],
                  static_cast<float>(1000 + 41 * i + o));
  }
  std::string ones;
  for (int i = 0; i < 41 * 41; ++i)
    ones += "1 ";
  MeasuredFile white = parse_measured(
      document("Columns", block("CIE-X", "Reflection Front", klems("Quarter"), x) +
                              block("Visible", "Reflection Front", klems("Quarter"), ones) +
                              block("CIE-Z", "Reflection Front", klems("Quarter"), z) +
                              block("Solar", "Reflection Front", klems("Quarter"), "nonsense")),
      "k.xml");
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(std::get<MeasuredPatches>(white.data).rgb[kBackReflection][c], 1, 4e-4);
}

TEST(MeasuredKlems, transmission_of_one_side_serves_the_other) {
  std::string values;
  for (int o = 0; o < 73; ++o)
    for (int i = 0; i < 73; ++i)
      values += fmt::format("{} ", 1 + 73 * i + o);
  MeasuredFile file = parse_measured(
      document("Columns", block("Visible", "Transmission Front", klems("Half"), values)), "k.xml");
  const auto& p = std::get<MeasuredPatches>(file.data);
  for (size_t i = 0; i < 73; ++i)
    for (size_t o = 0; o < 73; ++o)
      ASSERT_EQ(p.rgb[kFrontTransmission][3 * (i * 73 + o)],
                p.rgb[kBackTransmission][3 * (o * 73 + i)]);
}

TEST(MeasuredKlems, a_basis_of_the_file) {
  std::string basis = "<AngleBasis><AngleBasisName>Two</AngleBasisName>"
                      "<AngleBasisBlock><ThetaBounds><LowerTheta>0</LowerTheta><UpperTheta>30"
                      "</UpperTheta></ThetaBounds><nPhis>1</nPhis></AngleBasisBlock>"
                      "<AngleBasisBlock><ThetaBounds><LowerTheta>30</LowerTheta><UpperTheta>90"
                      "</UpperTheta></ThetaBounds><nPhis>2</nPhis></AngleBasisBlock></AngleBasis>";
  std::string bases = "<ColumnAngleBasis>Two</ColumnAngleBasis><RowAngleBasis>Two</RowAngleBasis>";
  MeasuredFile file = parse_measured(
      document("Columns", block("Visible", "Reflection Back", bases, "1 2 3 4 5 6 -7 8 9"), basis),
      "k.xml");
  const auto& p = std::get<MeasuredPatches>(file.data);
  EXPECT_EQ(p.incident.cells, (std::vector<int>{1, 2}));
  EXPECT_NEAR(p.incident.theta[1], kPi / 6, 1e-12);
  EXPECT_EQ(file.info.negative, 1);
  EXPECT_EQ(p.rgb[kFrontReflection][3 * 2], 0); // light 0, leaving by 2: -7
  EXPECT_EQ(p.rgb[kFrontReflection][3 * (2 * 3 + 1)], 5);
}

TEST(MeasuredTensorTree, rank_4_is_looked_up_where_radiance_looks) {
  // a grid of 4 x 4 x 4 x 4 cells under one level of branches: 8 cells a side
  auto cell_value = [](const std::array<int, 4>& c) {
    return 1 + c[0] + 8 * c[1] + 64 * c[2] + 512 * c[3];
  };
  std::string text = "{";
  for (int n = 0; n < 16; ++n) {
    text += "\n{";
    for (int g = 0; g < 256; ++g) {
      std::array<int, 4> c = {g >> 6 & 3, g >> 4 & 3, g >> 2 & 3, g & 3}; // the last is fastest
      for (int d = 0; d < 4; ++d)
        c[d] += (n >> d & 1) * 4;
      text += fmt::format("{}{}", cell_value(c), g % 2 == 0 ? "," : "\t");
    }
    text += "}";
  }
  text += "}\n";
  MeasuredFile file = parse_measured(
      document("TensorTree4", block("Visible", "Reflection Back", kTree, text)), "t.xml");
  EXPECT_EQ(file.info.format, "tensortree");
  const auto& tree = std::get<MeasuredTree>(file.data);
  EXPECT_EQ(tree.depth, 3);
  EXPECT_EQ(file.info.cells, 4096);
  for (double ti : {0.0, 0.31, 0.77, 1.4})
    for (double pi : {0.1, 1.3, 2.9, 4.4})
      for (double to : {0.12, 0.62, 1.33})
        for (double po : {0.3, 2.2, 3.9, 5.8}) {
          Dir wi = spherical(ti, pi), wo = spherical(to, po);
          auto a = disk_to_square(-wi.x, -wi.y), b = disk_to_square(wo.x, wo.y);
          std::array<int, 4> c = {static_cast<int>(8 * a[0]), static_cast<int>(8 * a[1]),
                                  static_cast<int>(8 * b[0]), static_cast<int>(8 * b[1])};
          if (ti == 0)
            continue; // between four cells
          auto light = disk_to_square(wi.x, wi.y);
          ASSERT_EQ(tree_value(tree, kFrontReflection, {light[0], light[1], b[0], b[1]}),
                    static_cast<float>(cell_value(c)));
        }
}

TEST(MeasuredTensorTree, transmission_of_one_side_serves_the_other) {
  std::string text = "{";
  for (int g = 0; g < 16; ++g)
    text += fmt::format("{} ", 1 + g);
  MeasuredFile file = parse_measured(
      document("TensorTree4", block("Visible", "Transmission Front", kTree, text + "}")), "t.xml");
  const auto& tree = std::get<MeasuredTree>(file.data);
  for (int g = 0; g < 16; ++g) {
    std::vector<double> p;
    for (int d = 0; d < 4; ++d)
      p.push_back(0.25 + 0.5 * (g >> d & 1));
    EXPECT_EQ(tree_value(tree, kBackTransmission, p),
              tree_value(tree, kFrontTransmission, {p[2], p[3], p[0], p[1]}));
  }
}

TEST(MeasuredTensorTree, rank_3_and_colours) {
  std::string y = "{{1}{2}{3}{4}{5}{6}{7}{8 9 10 11 12 13 14 15}}", white_u = "{0.19783}",
              white_v = "{0.46834}";
  MeasuredFile file = parse_measured(
      document("TensorTree3", block("Visible", "Reflection Front", kTree, y) +
                                  block("CIE-u", "Reflection Front", kTree, white_u) +
                                  block("CIE-v", "Reflection Front", kTree, white_v)),
      "t.xml");
  const auto& tree = std::get<MeasuredTree>(file.data);
  EXPECT_EQ(tree.dimensions, 3);
  EXPECT_EQ(tree.depth, 2);
  EXPECT_EQ(file.info.cells, 15);
  EXPECT_NEAR(tree_value(tree, kBackReflection, {0.2, 0.8, 0.3}), 3, 1e-3);
  EXPECT_NEAR(tree_value(tree, kBackReflection, {0.8, 0.3, 0.3}), 2, 1e-3);
  // the grid: upper half of all three, then its last coordinate's upper half
  EXPECT_NEAR(tree_value(tree, kBackReflection, {0.6, 0.6, 0.9}), 9, 4e-3);
  EXPECT_NEAR(tree_value(tree, kBackReflection, {0.9, 0.6, 0.6}), 12, 4e-3);
  const auto& rgb = tree.rgb[kBackReflection];
  for (size_t i = 0; i < rgb.size(); i += 3)
    EXPECT_NEAR(rgb[i + 2] / rgb[i], 1, 2e-3); // D65 is grey
}

TEST(MeasuredWindow, says_what_is_wrong_and_where) {
  auto k = [](const std::string& values) {
    return document("Columns", block("Visible", "Reflection Back", klems("Quarter"), values));
  };
  int column = static_cast<int>(
      block("Visible", "Reflection Back", klems("Quarter"), "").find("</ScatteringData>") + 1);
  auto place = [](const std::string& tag) {
    return static_cast<int>(block("Visible", "Reflection Back", klems("Third"), "").find(tag) + 1);
  };
  expect_error(k("1 2 x"), 6, column + 4, "'x'");
  expect_error(k("1 2\n3 nan"), 7, 3, "not a finite number");
  expect_error(k("1 2 3"), 6, column + 5, "3 values, not 41 x 41");
  expect_error(document("Columns", ""), 3, 10, "no WavelengthData for Visible");
  expect_error(document("Columns", block("Solar", "Reflection Back", klems("Half"), "1")), 3, 10,
               "the file has Solar");
  expect_error(document("Tensor", block("Visible", "Reflection Back", klems("Half"), "1")), 5, 17,
               "unknown IncidentDataStructure 'Tensor'");
  expect_error(document("Columns", block("Visible", "Sideways", klems("Half"), "1")), 6,
               place("<WavelengthDataDirection>"), "unknown WavelengthDataDirection");
  expect_error(document("Columns", block("Visible", "Reflection Back", klems("Third"), "1")), 6,
               place("<ColumnAngleBasis>"), "unknown angle basis 'LBNL/Klems Third'");
  auto t = [](const std::string& values) {
    return document("TensorTree4", block("Visible", "Reflection Back", kTree, values));
  };
  column = static_cast<int>(
      block("Visible", "Reflection Back", kTree, "").find("</ScatteringData>") + 1);
  expect_error(t("{1 2 3}"), 6, column + 1, "3 values make no grid of 4 dimensions");
  expect_error(t("{{1}{2}"), 6, column + 7, "'{' expected in the tensor tree, but it ends");
  expect_error(t("{1} 2"), 6, column + 4, "more text behind");
  expect_error(t("{1 inf}"), 6, column + 3, "'inf}'");
  expect_error(t(std::string(100000, '{')), 6, column + 17, "deeper than 16 levels");
  expect_error("<WindowElement><Optical></WindowElement>", 1, 27, "");
  expect_error("<WindowElement/>", 1, 1, "no <Optical>");
}
