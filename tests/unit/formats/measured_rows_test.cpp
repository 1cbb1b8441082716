#include "formats/measured_curet.h"
#include "measured_checks.h"

#include <bit>
#include <chrono>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <set>
#include <unistd.h>

using namespace faceta;
using namespace faceta::test;

namespace {

MeasuredOptions with_wavelength(double nm) {
  MeasuredOptions options;
  options.wavelength = nm;
  return options;
}

/// A CSV table of the model on a full grid.
std::string csv_grid(const std::string& header, double unit) {
  std::string text = "# made by a test\n" + header + "\n";
  for (double ti : {0.0, 30.0, 60.0, 80.0})
    for (double to : {0.0, 20.0, 45.0, 75.0})
      for (int dphi = 0; dphi <= 180; dphi += 30)
        text +=
            fmt::format("{},{},{},{},{}\n", ti * unit, 40 * unit, to * unit, (dphi + 40) * unit,
                        model(spherical(ti * kDegree, 0), spherical(to * kDegree, dphi * kDegree)));
  return text;
}

} // namespace

TEST(MeasuredCornell, colours_are_those_of_mitsuba) {
  struct Row {
    const char* file;
    double ti, to, po, rgb[3], at_555;
  };
  // mi.spectrum_list_to_srgb of Mitsuba 3.9.1, unbounded and lit by D65, of rows 0, 700 and 1438,
  // the curve carried on beyond its ends, over that of the constant 1; and numpy's interp at 555 nm
  const Row rows[] = {
      {"garnet_red", 0.872665, 0.573513, 0, {0.03503039, 0.00323196, 0.00655669}, 0.004368},
      {"garnet_red", 0.698132, 0.427512, kPi, {0.13600151, 0.07072093, 0.07430187}, 0.073198},
      {"garnet_red", 1.396263, 1.379634, kPi, {32.68995, 29.862686, 31.275856}, 28.275897},
      {"krylon_blue", 0.872665, 0.573513, 0, {0, 0.01592841, 0.08220668}, 0.0078175},
      {"krylon_blue", 0.698132, 0.427512, kPi, {0.05151799, 0.07382867, 0.13781613}, 0.06578},
      {"krylon_blue", 1.396263, 1.379634, kPi, {39.19242, 38.161945, 66.955215}, 35.0741015}};
  for (const Row& row : rows) {
    std::string path = real_file(std::string("cornell/") + row.file + ".brdf");
    if (path.empty())
      GTEST_SKIP() << "the Cornell files are not there";
    // one row alone is a constant
    std::string bytes = read_whole_file(path), head, wanted;
    std::istringstream lines(bytes);
    std::string start = fmt::format("{:.6f} {:.6f} {:.6f} {:.6f}", row.ti, 0.0, row.to, row.po);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with(start))
        wanted = line;
      else if (line.find('.') == line.npos)
        head += line + "\n";
    ASSERT_FALSE(wanted.empty()) << start;
    Dir wi = spherical(row.ti, 0), wo = spherical(row.to, row.po);
    MeasuredFile file = parse_measured(head + wanted + "\n", "one.brdf");
    auto rgb = grid_value(file, wi, wo);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(rgb[c], row.rgb[c], 2e-3 * row.rgb[c] + 1e-5) << row.file << " " << start;
    EXPECT_EQ(file.info.negative, row.rgb[0] == 0 ? 1 : 0);
    MeasuredFile grey = parse_measured(head + wanted + "\n", "one.brdf", with_wavelength(555));
    EXPECT_NEAR(grid_value(grey, wi, wo)[1], row.at_555, 1e-5 * row.at_555);
  }
}

TEST(MeasuredCornell, real_files_have_their_lobe_at_the_mirror_direction) {
  std::string path = real_file("cornell/garnet_red.brdf");
  if (path.empty())
    GTEST_SKIP() << "the Cornell files are not there";
  auto start = std::chrono::steady_clock::now();
  MeasuredFile file = read_measured(path);
  RecordProperty("milliseconds",
                 static_cast<int>((std::chrono::steady_clock::now() - start).count() / 1000000));
  EXPECT_EQ(file.info.format, "cornell");
  EXPECT_EQ(file.info.cells, 1439);
  EXPECT_EQ(file.info.holes, 0);
  EXPECT_EQ(file.info.wavelengths.size(), 31U);
  EXPECT_NEAR(file.info.largest_theta, 80 * kDegree, 1e-5);
  EXPECT_NE(file.info.description.find("Garnet Red"), std::string::npos);
  expect_valid(std::get<MeasuredGrid>(file.data));
  Dir wi = spherical(60 * kDegree, 0.3);
  double mirror = grid_value(file, wi, spherical(60 * kDegree, 0.3 + kPi))[1];
  double back = grid_value(file, wi, spherical(60 * kDegree, 0.3))[1];
  EXPECT_GT(mirror, 50 * back);
}

TEST(MeasuredCsv, a_full_grid_keeps_its_angles) {
  for (bool radians : {false, true}) {
    MeasuredFile file = parse_measured(
        radians ? csv_grid("theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,value", kDegree)
                : csv_grid("theta_i, phi_i_deg, theta_o, phi_o, value", 1),
        "grid.csv");
    EXPECT_EQ(file.info.format, "csv");
    EXPECT_EQ(file.info.resolution, "4 x 4 x 7 (theta_i, theta_o, dphi)");
    EXPECT_EQ(file.info.cells, 112);
    EXPECT_EQ(file.info.holes, 0);
    EXPECT_NEAR(file.info.largest_theta, 80 * kDegree, 1e-9);
    const auto& grid = std::get<MeasuredGrid>(file.data);
    expect_valid(grid);
    for (double ti : {30.0, 60.0, 80.0})
      for (double to : {20.0, 45.0, 75.0})
        for (double dphi : {0.0, 60.0, -150.0, 180.0}) {
          Dir wi = spherical(ti * kDegree, 1), wo = spherical(to * kDegree, 1 + dphi * kDegree);
          EXPECT_NEAR(grid_value(file, wi, wo)[2], model(wi, wo), 1e-6);
        }
  }
}

TEST(MeasuredCsv, columns_in_any_order_and_of_any_kind) {
  // two angles of each kind; the colours of XYZ white and of a flat spectrum are grey
  std::string xyz = "Z,theta_o,theta_i,X,dphi,Y\n", bands = "700nm,theta_i,theta_o,dphi,400nm\n",
              rgb = "b,g,r,theta_i,theta_o,dphi,phi_i\n";
  for (int ti : {10, 50})
    for (int to : {20, 40})
      for (int dphi : {0, 90, 180}) {
        xyz += fmt::format("1.089058,{},{},0.950456,{},1\n", to, ti, dphi);
        bands += fmt::format("{},{},{},{},{}\n", 0.3, ti, to, dphi, 0.3);
        rgb += fmt::format("3,-2,1,{},{},{},7\n", ti, to, dphi);
      }
  Dir wi = spherical(0.4, 1), wo = spherical(0.5, 2);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(grid_value(parse_measured(xyz, "x"), wi, wo)[c], 1, 4e-4);
    EXPECT_NEAR(grid_value(parse_measured(bands, "x"), wi, wo)[c], 0.3, 1e-6);
    EXPECT_NEAR(grid_value(parse_measured(rgb, "x"), wi, wo)[c], c == 1 ? 0 : c + 1, 1e-6);
  }
  EXPECT_EQ(parse_measured(rgb, "x").info.negative, 12);
  EXPECT_EQ(parse_measured(bands, "x").info.wavelengths, (std::vector<double>{400, 700}));
}

TEST(MeasuredCsv, anisotropic_grids_and_holes) {
  std::string text = "theta_i,phi_i,theta_o,phi_o,value\n";
  int rows = 0;
  for (int ti : {20, 60})
    for (int pi = 0; pi < 360; pi += 60)
      for (int to : {0, 30, 60})
        for (int po = 0; po < 360; po += 45) {
          bool normal = to == 0 && po > 0; // the normal is measured once
          bool hole = to == 30 && po == 45 && ti == 20;
          if (normal || hole)
            continue;
          text += fmt::format("{},{},{},{},{}\n", ti, pi, to, po,
                              model(spherical(ti * kDegree, pi * kDegree),
                                    spherical(to * kDegree, po * kDegree), 2));
          ++rows;
        }
  MeasuredFile file = parse_measured(text, "a.csv");
  EXPECT_EQ(file.info.cells, rows);
  EXPECT_EQ(file.info.holes, 6);
  EXPECT_EQ(file.info.resolution, "2 x 6 x 3 x 8 (theta_i, phi_i, theta_o, phi_o)");
  for (double po : {0.0, 135.0, 315.0}) {
    Dir wi = spherical(60 * kDegree, 120 * kDegree), wo = spherical(30 * kDegree, po * kDegree);
    EXPECT_NEAR(grid_value(file, wi, wo)[0], model(wi, wo, 2), 1e-6);
    EXPECT_NEAR(grid_value(file, wi, spherical(1e-9, po * kDegree))[0],
                model(wi, spherical(0, 0), 2), 1e-6);
  }
}

TEST(MeasuredAstm, rows_turned_by_the_azimuth_of_the_light) {
  std::string text = "TIME \"12 May\"\nOPERATOR nobody\nNUM_POINTS 48\n"
                     "VARS theta_i,phi_i,theta_s,phi_s,R,G,B\n";
  for (double ti : {0.2, 0.9, 1.3, 1.4})
    for (double to : {-0.7, 0.3, 0.7})
      for (double dphi : {0.0, 1.0, 2.0, 3.0}) {
        // a negative polar angle is the other side of the normal
        double f = model(spherical(ti, 0), spherical(std::abs(to), to < 0 ? dphi + kPi : dphi));
        text += fmt::format("{:.6f},0.500000,{:.6f},{:.6f},{},{},{}\r\n", ti, to, 0.5 + dphi, f,
                            2 * f, 3 * f);
      }
  MeasuredFile file = parse_measured(text, "a.astm");
  EXPECT_EQ(file.info.format, "astm");
  EXPECT_NE(file.info.description.find("OPERATOR: nobody"), std::string::npos);
  for (double dphi : {1.0, 3.0}) {
    Dir wi = spherical(0.9, 0), wo = spherical(0.7, dphi);
    double f = model(wi, wo);
    auto v = grid_value(file, wi, wo);
    EXPECT_NEAR(v[0], f, 0.02 * f);
    EXPECT_NEAR(v[2], 3 * f, 0.06 * f);
  }
}

TEST(MeasuredTvbrdf, radiance_is_divided_by_the_cosine) {
  std::string text = "Exposure 0.2 4.0 32.0\n";
  std::vector<std::pair<Dir, Dir>> pairs;
  for (int i = 0; i < 2000; ++i) {
    Dir l = spherical(1.3 * (i % 50) / 50, i * 0.7), v = spherical(1.3 * (i / 50) / 40, i * 1.3);
    double f = model(l, v) * l.z;
    text += fmt::format("F {} {} {}\nL {} {} {}\nV {} {} {}\n", 0.5 * f, f, 2 * f, l.x, l.y, l.z,
                        v.x, v.y, v.z);
    pairs.push_back({l, v});
  }
  text += "F 1 1 1\nL 1 0 0.001\nV 0 0 1\n";
  MeasuredFile file = parse_measured(text, "scan01_brdf_camera1_allexposures.txt");
  EXPECT_EQ(file.info.format, "tvbrdf");
  EXPECT_EQ(file.info.cells, 2000);
  double mean = 0;
  for (const auto& [l, v] : pairs) {
    auto rgb = grid_value(file, l, v);
    mean += std::abs(rgb[1] / model(l, v) - 1) / 2000;
    EXPECT_NEAR(rgb[0], 2 * rgb[1], 0.05 * rgb[0]);
    EXPECT_NEAR(rgb[2], 0.5 * rgb[1], 0.05 * rgb[1]);
  }
  EXPECT_LT(mean, 0.02);
}

TEST(MeasuredCuret, directions_are_those_of_the_published_table) {
  struct Row {
    int number;
    double theta_v, phi_v, theta_i, phi_i;
  };
  // rows of the table of directions that goes with the database
  const Row rows[] = {{1, 1.389566, -1.970402, 1.374447, -1.570796},
                      {55, 0.392699, 3.141593, 0, 0},
                      {56, 1.432405, -2.365895, 1.374447, -1.570796},
                      {70, 0.523599, -0.886076, 1.150262, -0.201358},
                      {85, 0.261800, -2.202711, 0.662145, -0.281035},
                      {103, 0.785398, 3.141593, 0, 0},
                      {105, 1.308097, -1.978257, 1.370707, -0.764828},
                      {126, 1.464020, -3.065729, 0.662145, -2.005315},
                      {142, 1.178097, 3.141593, 0, 0},
                      {144, 1.370707, -2.376765, 1.370707, -0.764828},
                      {170, 1.374447, 3.141593, 0.196349, 0},
                      {172, 1.463021, -2.763231, 1.370707, -0.764828},
                      {189, 1.374447, 3.141593, 0.589048, 0},
                      {194, 1.308997, -2.790714, 1.357866, -0.281035},
                      {200, 1.374446, 3.141593, 0.981748, 0},
                      {202, 1.374447, 3.141593, 1.374447, 0},
                      {205, 1.464020, -3.065729, 1.357866, -0.153484}};
  for (const Row& row : rows) {
    const CuretDirections& d = curet_directions()[static_cast<size_t>(row.number - 1)];
    Dir a = spherical(d.theta_o, d.phi_o), b = spherical(row.theta_v, row.phi_v);
    EXPECT_NEAR(dot(a, b), 1, 1e-10) << row.number;
    a = spherical(d.theta_i, d.phi_i);
    b = spherical(row.theta_i, row.phi_i);
    EXPECT_NEAR(dot(a, b), 1, 1e-10) << row.number;
  }
}

TEST(MeasuredCuret, materials_by_number_and_three_files_as_one) {
  std::string tables[3];
  for (int c = 0; c < 3; ++c)
    for (int material = 1; material <= 2; ++material) {
      tables[c] += fmt::format("{}  ", material);
      for (const CuretDirections& d : curet_directions())
        tables[c] += fmt::format(
            "  {:.5f}", material * (c + 1) *
                            model(spherical(d.theta_i, d.phi_i), spherical(d.theta_o, d.phi_o)));
      tables[c] += " \n";
    }
  MeasuredOptions second;
  second.index = 2;
  Dir wi = spherical(0.6, 0), wo = spherical(0.5, 2.5);
  double f = model(wi, wo);
  MeasuredFile grey = parse_measured(tables[0], "abrdf.dat", second);
  EXPECT_EQ(grey.info.format, "curet");
  EXPECT_EQ(grey.info.cells, 205);
  EXPECT_NEAR(grid_value(grey, wi, wo)[0], 2 * f, 0.3 * f);
  EXPECT_EQ(grid_value(grey, wi, wo)[0], grid_value(grey, wi, wo)[2]);

  auto folder = std::filesystem::temp_directory_path() / fmt::format("faceta-curet-{}", ::getpid());
  std::filesystem::create_directories(folder);
  for (int c = 0; c < 3; ++c)
    std::ofstream(folder / (std::string(1, "rgb"[c]) + "brdf.dat")) << tables[c];
  MeasuredFile color = read_measured((folder / "gbrdf.dat").string());
  std::filesystem::remove_all(folder);
  auto rgb = grid_value(color, wi, wo);
  EXPECT_NEAR(rgb[1], 2 * rgb[0], 1e-3);
  EXPECT_NEAR(rgb[2], 3 * rgb[0], 2e-3);
  MeasuredOptions third;
  third.index = 3;
  expect_error(tables[0], 3, 1, "there is no material 3", third);
  expect_error("1 0.3 0.2 0.1\n2 0.3 0.2 0.1\n", 1, 1, "Oren-Nayar");
  expect_error("1 0.3 0.2 0.1 0.1 0.1\n", 1, 1, "Koenderink");
}

TEST(MeasuredZemax, lobes_about_the_mirror_direction) {
  // the article of the format: azimuth 0 points from the mirror direction towards the normal
  auto value = [](double incidence, double azimuth, double radial) {
    return 1 + incidence + 2 * radial + 0.5 * std::cos(azimuth) + 0.25 * std::sin(azimuth);
  };
  for (bool symmetric : {true, false}) {
    std::string text =
        fmt::format("# comment\nSource  Measured\nSymmetry  {}\nSpectralContent  Monochrome\n"
                    "ScatterType  BRDF\nSampleRotation  1\n0\nAngleOfIncidence  2\n30 60\n"
                    "ScatterAzimuth {}\nScatterRadial 3\n0 10 40\n\nMonochrome\nDataBegin\n",
                    symmetric ? "PlaneSymmetrical" : "ASymmetrical",
                    symmetric ? "3\n0 90 180" : "4\n0 90 180 270");
    for (int ti : {30, 60}) {
      text += "TIS 0.5\n";
      for (int azimuth = 0; azimuth < (symmetric ? 181 : 360); azimuth += 90)
        for (int radial : {0, 10, 40})
          text += fmt::format("{}\t", value(ti * kDegree, azimuth * kDegree, radial * kDegree));
    }
    MeasuredFile file = parse_measured(text + "\nDataEnd\n", "z.bsdf");
    EXPECT_EQ(file.info.format, "zemax");
    expect_valid(std::get<MeasuredGrid>(file.data));
    Dir wi = spherical(60 * kDegree, 0);
    // 10 degrees from the mirror direction: towards the normal, away from it, and aside
    EXPECT_NEAR(grid_value(file, wi, spherical(50 * kDegree, kPi))[0],
                value(60 * kDegree, 0, 10 * kDegree), 1e-6);
    EXPECT_NEAR(grid_value(file, wi, spherical(70 * kDegree, kPi))[0],
                value(60 * kDegree, kPi, 10 * kDegree), 1e-6);
    // counter-clockwise about the mirror direction seen from outside: from the normal to +y
    Dir r = spherical(60 * kDegree, kPi), y = {0, 1, 0};
    double c = std::cos(10 * kDegree), s = std::sin(10 * kDegree);
    Dir left = {c * r.x, s * y.y, c * r.z}, right = {c * r.x, -s, c * r.z};
    EXPECT_NEAR(grid_value(file, wi, left)[0], value(60 * kDegree, kPi / 2, 10 * kDegree), 1e-6);
    EXPECT_NEAR(grid_value(file, wi, right)[0],
                value(60 * kDegree, symmetric ? kPi / 2 : 1.5 * kPi, 10 * kDegree), 1e-6);
  }
}

TEST(MeasuredZemax, colours_and_rotations) {
  std::string text =
      "Symmetry ASymmetrical4D\nSpectralContent XYZ\nScatterType BRDF\n"
      "SampleRotation 3\n0 120 240\nAngleOfIncidence 1\n40\nScatterAzimuth 2\n0 180\n"
      "ScatterRadial 2\n0 90\n";
  const char* names[] = {"TristimulusX", "TristimulusY", "TristimulusZ"};
  const double white[] = {0.950456, 1, 1.089058};
  for (int c = 0; c < 3; ++c) {
    text += std::string(names[c]) + "\n";
    for (int rotation = 0; rotation < 3; ++rotation) {
      text += "TIS 1\n";
      for (int i = 0; i < 4; ++i)
        text += fmt::format("{} ", white[c] * (1 + rotation));
    }
  }
  MeasuredFile file = parse_measured(text, "z.bsdf");
  for (int rotation = 0; rotation < 3; ++rotation) {
    Dir wi = spherical(40 * kDegree, (90 + 120 * rotation) * kDegree);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(grid_value(file, wi, spherical(0.3, 1))[c], 1 + rotation, 2e-3);
  }
}

TEST(MeasuredLighttools, light_comes_from_ninety_degrees) {
  std::string text = "Symmetry Asymmetric\nSpectralContent Monochrome\nScatterAzimuth 4\n"
                     "0 90 180 270\nScatterRadial 3\n0 30 60\nDataBegin\n";
  auto add = [&](int aoi, int nm, const std::string& side, const std::string& type, double scale) {
    text += fmt::format("AOI {} POI 0 Side {} Wavelength {} ScatterType {} TIS 0.3\n", aoi, side,
                        nm, type);
    for (int azimuth = 0; azimuth < 360; azimuth += 90)
      for (int radial : {0, 30, 60})
        text += fmt::format("{} ", scale * (1 + aoi + azimuth / 90.0 + 10 * radial));
    text += "\n";
  };
  add(0, 550, "Front", "BRDF", 1);
  add(40, 550, "Front", "BRDF", 1);
  add(40, 550, "Back", "BRDF", 100);
  add(40, 550, "Front", "BTDF", 100);
  MeasuredFile file = parse_measured(text + "DataEnd\n", "l.bsdf");
  EXPECT_EQ(file.info.format, "lighttools");
  expect_valid(std::get<MeasuredGrid>(file.data));
  Dir wi = spherical(40 * kDegree, 90 * kDegree);
  for (int azimuth = 0; azimuth < 360; azimuth += 90)
    EXPECT_NEAR(grid_value(file, wi, spherical(30 * kDegree, azimuth * kDegree))[0],
                1 + 40 + azimuth / 90.0 + 300, 1e-4);
  EXPECT_FALSE(file.info.notes.empty());
  add(0, 650, "Front", "BRDF", 3);
  add(40, 650, "Front", "BRDF", 3);
  MeasuredFile bands = parse_measured(text + "DataEnd\n", "l.bsdf", with_wavelength(600));
  EXPECT_NEAR(grid_value(bands, wi, spherical(30 * kDegree, 0))[0], 2 * (1 + 40 + 300), 1e-3);
}

TEST(MeasuredAlta, half_angle_grids_and_cosines) {
  std::string text =
      "#ALTA BEGIN HEADER\n#DIM 3 3\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT RGB_COLOR\n"
      "#ALTA END HEADER\n";
  for (double h : {0.0, 0.2, 0.9, 1.5})
    for (double d : {0.0, 0.7, 1.5})
      for (int p = 0; p < 6; ++p)
        text += fmt::format("{} {} {} {} {} {}\n", h, d, p * kPi / 6, 1 + h, 1 + d, 1 + p);
  MeasuredFile file = parse_measured(text, "m.alta");
  EXPECT_EQ(file.info.format, "alta");
  EXPECT_EQ(file.info.resolution, "4 x 3 x 6 (theta_h, theta_d, phi_d)");
  const auto& grid = std::get<MeasuredGrid>(file.data);
  EXPECT_NEAR(grid.axes[2].period, kPi, 1e-12);
  auto v = grid_value(grid, {0.2, 0.7, kPi / 6 + kPi});
  EXPECT_NEAR(v[0], 1.2, 1e-6);
  EXPECT_NEAR(v[1], 1.7, 1e-6);
  EXPECT_NEAR(v[2], 2, 1e-6);

  std::string slice = "#DIM 1 1\n#PARAM_IN COS_TH\n#PARAM_OUT INV_STERADIAN\n#VS 2\n";
  for (int i = 0; i <= 10; ++i)
    slice += fmt::format("{} {} 0 1\n", i / 10.0, 1 + i);
  Dir wi = spherical(std::acos(0.8), 0), wo = wi;
  EXPECT_NEAR(grid_value(parse_measured(slice, "s.alta"), wi, wo)[0], 9, 1e-5);
}

TEST(MeasuredAlta, directions_of_every_parametrisation) {
  // the same pairs of directions in every way of writing them give the same table
  auto angles = [](const char* name, const Dir& l, const Dir& v) -> std::vector<double> {
    std::string n = name;
    double dphi = azimuth(v) - azimuth(l);
    if (n == "SPHERICAL_TL_PL_TV_PV")
      return {polar(l), azimuth(l), polar(v), azimuth(v)};
    if (n == "ISOTROPIC_TV_TL_DPHI")
      return {polar(v), polar(l), dphi};
    if (n == "ISOTROPIC_TL_TV_PROJ_DPHI")
      return {polar(l), polar(v) * std::cos(dphi), polar(v) * std::sin(dphi)};
    if (n == "CARTESIAN")
      return {v.x, v.y, v.z, l.x, l.y, l.z};
    if (n == "RETRO_TL_TVL_PROJ_DPHI") {
      double apart = std::acos(std::min(1.0, dot(l, v)));
      Dir up = spherical(polar(l) - kPi / 2, azimuth(l)), side = cross(up, l);
      double turn = std::atan2(-dot(v, side), dot(v, up));
      return {polar(l), apart * std::cos(turn), apart * std::sin(turn)};
    }
    Dir h = unit({l.x + v.x, l.y + v.y, l.z + v.z});
    std::vector<double> a = grid_angles(MeasuredCoordinates::half_difference, v, l);
    if (n == "RUSIN_TH_PH_TD_PD")
      return {a[0], azimuth(h), a[1], a[2]};
    return a;
  };
  std::vector<double> first;
  for (const char* name :
       {"SPHERICAL_TL_PL_TV_PV", "ISOTROPIC_TV_TL_DPHI", "ISOTROPIC_TL_TV_PROJ_DPHI", "CARTESIAN",
        "RETRO_TL_TVL_PROJ_DPHI", "RUSIN_TH_PH_TD_PD", "RUSIN_TH_TD_PD"}) {
    std::string rows;
    size_t dimension = 0;
    for (int i = 0; i < 1500; ++i) {
      Dir l = spherical(1.3 * std::fmod(i * 0.618, 1), 0),
          v = spherical(1.3 * (i % 97) / 97, i * 2.4);
      std::vector<double> x = angles(name, l, v);
      dimension = x.size();
      for (double a : x)
        rows += fmt::format("{} ", a);
      rows += fmt::format("{}\n", model(l, v) * l.z);
    }
    MeasuredFile file = parse_measured(fmt::format("#DIM {} 1\n#PARAM_IN {}\n#PARAM_OUT "
                                                   "INV_STERADIAN_COSINE_FACTOR\n{}",
                                                   dimension, name, rows),
                                       "d.alta");
    EXPECT_EQ(file.info.symmetries[0], "isotropic");
    EXPECT_EQ(file.info.cells, 1500);
    double mean = 0;
    for (int i = 0; i < 200; ++i) {
      Dir l = spherical(0.1 + 1.1 * (i % 10) / 10, 0.2), v = spherical(0.1 + 1.1 * i / 200, i);
      double value = grid_value(file, l, v)[0];
      mean += std::abs(value / model(l, v) - 1) / 200;
      if (first.size() < 200)
        first.push_back(value);
      EXPECT_NEAR(value, first[i], 1e-3 * value) << name;
    }
    EXPECT_LT(mean, 0.05) << name;
  }
}

TEST(MeasuredAlta, binary_of_both_byte_orders) {
  for (bool big : {false, true}) {
    std::string text = fmt::format("#DIM 2 1\n#PARAM_IN RUSIN_TH_TD\n#PARAM_OUT INV_STERADIAN\n"
                                   "#FORMAT binary\n#VERSION 0\n#PRECISION ieee754-double\n"
                                   "#SAMPLE_COUNT 6\n#VS 0\n#ENDIAN {}\n#BEGIN_STREAM\n",
                                   big ? "big" : "little");
    for (double h : {0.1, 0.5, 0.9})
      for (double d : {0.2, 0.4})
        for (double x : {h, d, 10 * h + d}) {
          auto bits = std::bit_cast<uint64_t>(x);
          for (int k = 0; k < 8; ++k)
            text += static_cast<char>(bits >> 8 * (big ? 7 - k : k));
        }
    MeasuredFile file = parse_measured(text + "\n#END_STREAM\n", "b.alta");
    EXPECT_EQ(file.info.cells, 6);
    EXPECT_NEAR(grid_value(std::get<MeasuredGrid>(file.data), {0.5, 0.4, 1})[0], 5.4, 1e-6);
    text.resize(text.size() - 9);
    try {
      parse_measured(text, "b.alta");
      FAIL();
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("at byte"), std::string::npos) << e.what();
    }
  }
}

TEST(MeasuredText, says_what_is_wrong_and_where) {
  expect_error("3\n400 500 600\n0.1 0 0.2 0 1 2\n", 4, 1, "but the file ends");
  expect_error("3\n400 500 600\n0.1 0 0.2 0 1 two 3\n", 3, 15, "not 'two'");
  expect_error("3\n400 500 600\n0.1 0 0.2 0 1 nan 3\n", 3, 15, "not a finite number");
  expect_error("3\n400 500 450\n0.1 0 0.2 0 1 2 3\n", 1, 1, "wavelengths must increase");
  expect_error("1000000000\n400 500\n", 1, 1, "from 1 to 2000");
  expect_error("2\n400 500\n1.7 0 0.2 0 1 2\n", 3, 1, "below the surface");
  expect_error("2\n400 500\n", 3, 1, "no measurement");
  expect_error("2\n400 500\n0.1 0 0.2 0 1 2\n", 1, 1, "was not measured", with_wavelength(700));

  expect_error("NUM_POINTS 1000000000\nVARS theta_i,phi_i,theta_s,phi_s,v\n0,0,0,0,1\n", 1, 12,
               "too short");
  expect_error("NUM_POINTS -4\n", 1, 12, "from 1 to");
  expect_error("NUM_POINTS 2\nVARS theta_i,phi_i,theta_s,phi_s,v\n0,0,0,0,1\n", 2, 1,
               "2 rows are declared, the file has 1");
  expect_error("VARS theta_i,theta_s,phi_s,v\n0,0,0,1\n", 1, 14, "column 2 of VARS is 'theta_s");
  expect_error("VARS theta_i,phi_i,theta_s,phi_s\n0,0,0,0\n", 1, 33, "names no values");
  expect_error("NUM_POINTS 2\nTIME noon and more words\n", 3, 1, "VARS is missing");

  expect_error("theta_i,theta_o,phi_o\n", 1, 1, "no column of values");
  expect_error("theta_i,theta_o,value\n", 1, 1, "exactly one of the columns phi_o and dphi");
  expect_error("theta_i,phi_o,value\n", 1, 1, "theta_i and theta_o must be there");
  expect_error("# c\ntheta_i,theta_o,phi_o,wrong,value\n", 2, 23, "unknown column 'wrong'");
  expect_error("theta_i,theta_i,phi_o,value\n", 1, 9, "occurs twice");
  expect_error("theta_i,theta_o,phi_o,value\n1,2,3\n", 2, 6, "the row has 3 numbers, not 4");
  expect_error("theta_i,theta_o,phi_o,value\n1,2,3,4,5\n", 2, 9, "more than 4 numbers");
  expect_error("theta_i,theta_o,phi_o,value\n1,2,3,4\n1,200,3,4\n", 3, 1, "200 degrees");
  expect_error("theta_i,theta_o,phi_o,value\n", 2, 1, "no measurement");
  expect_error("theta_i,theta_o,phi_o,value\n1,2,3,4\n", 1, 1, "it holds colours",
               with_wavelength(500));

  expect_error("F 1 2 3\nL 0 0 1\nV 0 0 0\n", 3, 7, "is zero");
  expect_error("F 1 2 3\nV 0 0 1\nL 0 0 1\n", 2, 1, "'L' expected");
  expect_error("1 0.1 0.2 0.3 0.4", 0, 0, "not a file");
}

TEST(MeasuredText, says_what_is_wrong_with_tables_of_optics_and_where) {
  std::string zemax = "Symmetry PlaneSymmetrical\nAngleOfIncidence 1\n30\nScatterAzimuth 2\n0 90\n"
                      "ScatterRadial 2\n0 9\nMonochrome\n";
  expect_error(zemax + "TIS 1\n1 2 3\n", 11, 1, "but the file ends");
  expect_error(zemax + "1 2 3 4\n", 9, 1, "'TIS' expected");
  expect_error(zemax + "TIS 1 1 2 3 4 5\n", 9, 15, "more values");
  expect_error("ScatterAzimuth 1\n0\nAngleOfIncidence 1\n30\nMonochrome\n", 4, 1,
               "Symmetry is missing");
  expect_error("ScatterType BTDF\nScatterAzimuth 1\n0\nAngleOfIncidence 1\n30\n", 1, 13, "BTDF");
  expect_error("ScatterAzimuth 100000\n0\nAngleOfIncidence 1\n30\n", 1, 16, "from 1 to 4096");
  expect_error("AngleOfIncidence 2\n30 20\nScatterAzimuth 1\n0\n", 2, 4, "must increase");

  std::string lighttools = "ScatterAzimuth 2\n0 90\nScatterRadial 1\n0\nDataBegin\n";
  expect_error(lighttools + "AOI 0 TIS 1 1 2\n", 7, 1, "without DataEnd");
  expect_error(lighttools + "AOI 0 TIS 1 1\nDataEnd", 7, 1, "not 'DataEnd'");
  expect_error(lighttools + "AOI 0 TIS 1 1 2\nAOI 0 TIS 1 1 2\nDataEnd", 7, 1, "a second block");
  expect_error(lighttools + "AOI 0 TIS 1 1 2\nAOI 5 POI 9 TIS 1 1 2\nDataEnd", 7, 1, "POI");
  expect_error(lighttools + "DataEnd", 5, 1, "no block");
  expect_error("ScatterAzimuth 2\n0 90\n", 3, 1, "DataBegin is missing");

  expect_error("#DIM 3 1\n#PARAM_IN STARK_3D\n#PARAM_OUT INV_STERADIAN\n", 2, 11, "RUSIN_TH_TD_PD");
  expect_error("#DIM 2 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n", 1, 1, "has 3");
  expect_error("#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT ENERGY\n", 3, 12, "'ENERGY'");
  expect_error("#DIM 1000000000 1\n", 1, 6, "from 1 to 6");
  expect_error("#DIM 1 1\n#PARAM_IN COS_TH\n#PARAM_OUT INV_STERADIAN\n1 2\n3\n", 5, 1, "not 2");
  expect_error("#PARAM_IN COS_TH\n\n#DIM 1 1\n#PARAM_OUT INV_STERADIAN\n1 x\n", 5, 3, "'x'");
}

TEST(MeasuredText, declared_sizes_are_checked_before_memory_is_taken) {
  std::string angles;
  for (int i = 0; i < 4000; ++i)
    angles += fmt::format("{} ", i * 0.0225);
  std::string zemax = "Symmetry PlaneSymmetrical\nAngleOfIncidence 4000\n" + angles +
                      "\nScatterAzimuth 4000\n" + angles + "\nScatterRadial 4000\n" + angles +
                      "\nMonochrome\nTIS 1\n";
  expect_error(zemax, 8, 1, "the file is too short");
  std::string alta = "#DIM 1 1\n#PARAM_IN COS_TH\n#PARAM_OUT INV_STERADIAN\n#FORMAT binary\n"
                     "#SAMPLE_COUNT 1000000000000\n#BEGIN_STREAM\n12345678";
  EXPECT_THROW(parse_measured(alta, "x"), Error);
}

TEST(MeasuredFormats, every_name_is_told_apart) {
  std::set<std::string> names;
  for (const MeasuredFormat& format : measured_formats())
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
  for (const char* name : {"cornell", "astm", "zemax", "lighttools", "alta", "klems", "tensortree",
                           "curet", "tvbrdf", "csv"})
    EXPECT_TRUE(names.contains(name)) << name;
}
