#include "formats/measured_loader.h"
#include "materials/measured_demo.h"
#include "mitsuba_test_tools.h"

#include <variant>

namespace faceta {
namespace {

std::string loading_error(const std::string& model, const Settings& settings) {
  load_measured_files();
  return xml::error_in([&] { make_parameters(model, settings).record(); });
}

TEST(MeasuredWindow, EitherModelNamesTheOtherForFilesThatAreNotItsOwn) {
  std::string text = loading_error("measured", {{"filename", "demo:shade"}});
  EXPECT_NE(text.find("use the model 'measuredwindow'"), std::string::npos) << text;
  text = loading_error("measuredwindow", {{"filename", "demo:plastic"}});
  EXPECT_NE(text.find("use the model 'measured'"), std::string::npos) << text;
  // A block that one of them has loaded is none of the other's.
  Record record = make_parameters("measuredwindow", {{"filename", "demo:shade"}}).record();
  text = loading_error("measured", {{"filename", "demo:shade"}});
  EXPECT_NE(text.find("use the model 'measuredwindow'"), std::string::npos) << text;
}

TEST(MeasuredWindow, ScenesCallBothMeasured) {
  load_measured_files();
  auto model = [](const std::string& type, const std::string& file) {
    return read_bsdf("type='" + type + "'><string name='filename' value='" + file + "'/>")
        ->parameters->model()
        .name();
  };
  EXPECT_EQ(model("measured", "demo:tree4"), "measuredwindow");
  EXPECT_EQ(model("measured", "demo:plastic"), "measured");
  EXPECT_EQ(model("measuredwindow", "demo:tree3"), "measuredwindow");
  EXPECT_NE(bsdf_error("type='measured'><string name='filename' value='demo:tree4'/>"
                       "<string name='merl_nodes' value='edges'/>")
                .find("merl_nodes"),
            std::string::npos);
}

Vec3<double> at(double theta, double phi) {
  theta *= kPi / 180;
  phi *= kPi / 180;
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Directions in the middle of cells of Klems's full basis, by inclination (of half the squared
/// sine) and azimuth.
std::vector<Vec3<double>> middles() {
  auto middle = [](double a, double b, double phi) {
    double x = std::sin(a * kPi / 180), y = std::sin(b * kPi / 180);
    return at(std::asin(std::sqrt(0.5 * (x * x + y * y))) * 180 / kPi, phi);
  };
  return {at(0, 0), middle(5, 15, 45), middle(25, 35, 18 * 7), middle(45, 55, -15),
          middle(65, 75, 22.5 * 9)};
}

TEST(MeasuredWindow, TheDemonstrationsAreWhatTheyAreMadeOf) {
  load_measured_files();
  Parameters shade = make_parameters("measuredwindow", {{"filename", "demo:shade"}});
  Record record = shade.record();
  for (Vec3<double> wo : middles())
    for (Vec3<double> wi : middles())
      for (int pass = 0; pass < 4; ++pass) {
        Vec3<double> o = wo, i = wi;
        i.z = pass == kBackReflection || pass == kBackTransmission ? -i.z : i.z;
        o.z = pass == kBackReflection || pass == kFrontTransmission ? -o.z : o.z;
        std::array<double, 3> f = demo_window(static_cast<MeasuredPass>(pass), i, o);
        Eval<double> e = shade.model().eval(record, {o, i});
        for (size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(e.value[int(c)], f[c] * std::abs(i.z), 1e-6) << pass;
      }
}

// Trees hold the middles of their cells: near what they were made of, on average, and far from it
// if light came from the opposite azimuth. Of rank 4 the cells are as wide as the narrow lobe.
TEST(MeasuredWindow, DemonstrationTreesComeNearWhatTheyAreMadeOf) {
  load_measured_files();
  for (const char* name : {"demo:tree3", "demo:tree4"}) {
    Parameters tree = make_parameters("measuredwindow", {{"filename", name}});
    Record record = tree.record();
    double error = 0, opposite = 0, sum = 0;
    for (int k = 0; k < 4000; ++k) {
      auto u = [&](double step) { return k * step - std::floor(k * step); };
      auto direction = [](double a, double b) {
        double z = 2 * a - 1, r = std::sqrt(1 - z * z);
        return Vec3<double>{r * std::cos(2 * kPi * b), r * std::sin(2 * kPi * b), z};
      };
      Vec3<double> wo = direction(u(0.8566749), u(0.7338918)),
                   wi = direction(u(0.6287067), u(0.5385972));
      MeasuredPass pass = wi.z > 0   ? wo.z > 0 ? kFrontReflection : kFrontTransmission
                          : wo.z < 0 ? kBackReflection
                                     : kBackTransmission;
      double f = demo_window(pass, wi, wo)[1] * std::abs(wi.z);
      double g = demo_window(pass, {-wi.x, -wi.y, wi.z}, wo)[1] * std::abs(wi.z);
      double value = tree.model().eval(record, {wo, wi}).value[1];
      error += std::abs(value - f);
      opposite += std::abs(value - g);
      sum += f;
    }
    EXPECT_LT(error / sum, 0.3) << name;
    EXPECT_LT(error, 0.5 * opposite) << name;
  }
}

} // namespace
} // namespace faceta
