#include "base/error.h"
#include "verify/plot.h"
#include "verify/plot_chart.h"

#include <cmath>
#include <gtest/gtest.h>
#include <pugixml.hpp>
#include <set>
#include <sstream>

namespace {

using namespace faceta;

PlotMaterial material(const std::string& model, const Settings& settings = {}) {
  return plot_material(make_parameters(model, settings));
}

// --- Axes ---

bool is_round(double value) {
  if (value == 0)
    return true;
  double digits = std::abs(value) / std::pow(10.0, std::floor(std::log10(std::abs(value)) + 1e-9));
  for (int most : {1, 10, 100}) // at most three digits
    if (std::abs(digits * most - std::round(digits * most)) < 1e-6)
      return true;
  return false;
}

TEST(Axis, LinearTicksAreRoundAndCoverTheRange) {
  for (double high : {1e-7, 0.013, 0.159, 0.5, 1.0, 1.0004, 7.3, 99.0, 123456.0})
    for (double low : {0.0, 0.3 * high, -high})
      for (int most : {2, 4, 5, 8}) {
        PlotAxis axis = linear_axis("", low, high, most);
        ASSERT_GE(axis.ticks.size(), 2u);
        EXPECT_LE(axis.ticks.size(), size_t(most) + 1);
        EXPECT_LE(axis.low, low + 1e-6 * high);
        EXPECT_GE(axis.high, high * (1 - 1e-6));
        EXPECT_EQ(axis.low, axis.ticks.front());
        EXPECT_EQ(axis.high, axis.ticks.back());
        double step = axis.ticks[1] - axis.ticks[0];
        double digit = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
        EXPECT_TRUE(std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 ||
                    std::abs(digit - 5) < 1e-6)
            << step;
        for (double t : axis.ticks)
          EXPECT_TRUE(is_round(t) || std::abs(t) < 1e-12 * high) << t;
      }
}

TEST(Axis, LogarithmicTicksArePowersOfTen) {
  for (auto [low, high] : {std::pair(0.02, 3.0), {1e-16, 1.0}, {1.0, 10.0}, {4.0, 5.0}}) {
    PlotAxis axis = logarithmic_axis("", low, high, 6);
    EXPECT_LE(axis.low, low * (1 + 1e-9));
    EXPECT_GE(axis.high, high * (1 - 1e-9));
    EXPECT_LE(axis.ticks.size(), 8u);
    for (double t : axis.ticks)
      EXPECT_NEAR(std::log10(t), std::round(std::log10(t)), 1e-9);
    EXPECT_EQ(axis.position(axis.low), 0);
    EXPECT_EQ(axis.position(axis.high), 1);
    EXPECT_NEAR(axis.position(std::sqrt(axis.low * axis.high)), 0.5, 1e-12);
    EXPECT_EQ(axis.position(0), 0);
  }
}

TEST(Axis, Numbers) {
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(0.25), "0.25");
  EXPECT_EQ(short_number(0.30000000000000004), "0.3");
  EXPECT_EQ(short_number(1000), "1000");
  EXPECT_EQ(short_number(25000), "25000");
  EXPECT_EQ(short_number(1e-6), "1e-6");
  EXPECT_EQ(short_number(2.5e7), "2.5e7");
  EXPECT_EQ(short_number(-0.5), "-0.5");
}

TEST(Text, LinesAreNeverTooWide) {
  std::string text =
      "a few words, and a_word_without_any_space_that_is_wider_than_the_line θθθθθθθθθ";
  for (double width : {60.0, 100.0, 1000.0}) {
    std::string together;
    for (const std::string& line : wrap_text(text, 12, width)) {
      EXPECT_LE(plot_text_width(line, 12), width);
      EXPECT_NE(static_cast<unsigned char>(line[0]) & 0xc0, 0x80); // no character is cut
      together += line;
    }
    std::string letters = text;
    std::erase(letters, ' ');
    std::erase(together, ' ');
    EXPECT_EQ(together, letters);
  }
}

TEST(Ramp, GrowsLighterAllTheWay) {
  double last = -1;
  for (int i = 0; i <= 100; ++i) {
    auto c = ramp_colour(i / 100.0);
    double luminance = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    EXPECT_GT(luminance, last) << i;
    last = luminance;
  }
  EXPECT_GT(last, 0.8);
}

// --- Drawings ---

std::vector<double> numbers(std::string text) {
  for (char& c : text)
    if (c == ',')
      c = ' ';
  std::istringstream stream(text);
  std::vector<double> result;
  for (double v; stream >> v;)
    result.push_back(v);
  EXPECT_TRUE(stream.eof()) << text; // nothing that is no number, "nan" for one
  return result;
}

/// Well-formed, every element inside the view box, every id of its own and of the drawing.
void check_svg(const std::string& text, const std::string& what, std::set<std::string>& ids) {
  SCOPED_TRACE(what);
  pugi::xml_document document;
  auto parsed = document.load_string(text.c_str(), pugi::parse_full);
  ASSERT_TRUE(parsed) << parsed.description();
  pugi::xml_node svg = document.child("svg");
  auto box = numbers(svg.attribute("viewBox").value());
  ASSERT_EQ(box.size(), 4u);
  auto inside = [&](double x, double y) {
    EXPECT_TRUE(x >= 0 && x <= box[2] && y >= 0 && y <= box[3]) << x << ", " << y;
  };
  std::string id = svg.attribute("id").value();
  EXPECT_TRUE(ids.insert(id).second) << id;
  int lines = 0;
  for (pugi::xml_node node : svg.children()) {
    std::string name = node.name();
    if (node.attribute("id")) {
      EXPECT_TRUE(ids.insert(node.attribute("id").value()).second);
    }
    if (name == "polyline" || name == "polygon") {
      auto values = numbers(node.attribute("points").value());
      ASSERT_EQ(values.size() % 2, 0u);
      for (size_t i = 0; i < values.size(); i += 2)
        inside(values[i], values[i + 1]);
      ++lines;
    } else if (name == "text") {
      double x = node.attribute("x").as_double(), y = node.attribute("y").as_double();
      double size = node.attribute("font-size").as_double();
      std::string anchor = node.attribute("text-anchor").as_string("start");
      double width = plot_text_width(node.text().get(), size, node.attribute("font-weight"));
      double left = x - (anchor == "middle" ? width / 2 : anchor == "end" ? width : 0);
      inside(left, y - 0.75 * size);
      inside(left + width, y + 0.25 * size);
      EXPECT_GE(size, 11) << "too small for a telephone";
    } else if (name == "image") {
      double x = node.attribute("x").as_double(), y = node.attribute("y").as_double();
      inside(x, y);
      inside(x + node.attribute("width").as_double(), y + node.attribute("height").as_double());
      EXPECT_EQ(std::string(node.attribute("href").value()).rfind("data:image/png;base64,iVBOR", 0),
                0u);
    } else {
      EXPECT_TRUE(name == "title" || name == "desc" || name == "style") << name;
    }
  }
  EXPECT_GT(lines, 3);
  EXPECT_STRNE(svg.child("title").text().get(), "");
}

std::vector<std::vector<PlotMaterial>> sets() {
  PlotMaterial gold = material("roughconductor", {{"material", "Au"}, {"alpha", "0.3"}});
  PlotMaterial metal = material("roughconductor", {{"distribution", "ggx"},
                                                   {"alpha_u", "0.05"},
                                                   {"alpha_v", "0.4"},
                                                   {"specular_reflectance", "0.9,0.5,0.2"}});
  return {{material("diffuse")},
          {material("dielectric")},
          {material("thindielectric")},
          {material("roughdielectric", {{"alpha", "0.2"}})},
          {material("conductor", {{"eta", "1.5"}, {"k", "0"}})},
          {gold, metal, material("plastic"), material("diffuse", {{"reflectance", "0"}})}};
}

TEST(Plot, EveryKindIsWellFormedAndInsideItsBox) {
  std::set<std::string> ids;
  for (const PlotKindInfo& info : plot_kinds())
    for (const auto& materials : sets()) {
      PlotOptions options;
      options.samples = 4096;
      std::string what = std::string(info.name) + " of " + materials[0].label;
      check_svg(to_svg(draw_plot(info.kind, materials, options)), what, ids);
    }
}

TEST(Plot, OptionsKeepEverythingInsideTheBox) {
  std::set<std::string> ids;
  PlotOptions options;
  options.samples = 4096;
  options.width = 300;
  options.phi = 25;
  options.colour = PlotColour::all;
  std::vector<PlotMaterial> two = {sets()[5][0], sets()[0][0]};
  for (PlotKind kind : {PlotKind::polar, PlotKind::slices, PlotKind::density})
    for (bool logarithmic : {false, true}) {
      options.logarithmic = logarithmic;
      check_svg(to_svg(draw_plot(kind, two, options)), "narrow", ids);
    }
  options = {};
  options.thetas = {10, 120, 179};
  check_svg(to_svg(draw_plot(PlotKind::polar, sets()[1], options)), "from inside", ids);
  options = {};
  options.inside = true;
  options.height = 700;
  options.width = 900;
  Drawing wide = draw_plot(PlotKind::albedo, sets()[1], options);
  EXPECT_EQ(wide.width, 900);
  EXPECT_EQ(wide.height, 700);
  check_svg(to_svg(wide), "wide", ids);
}

TEST(Plot, LambertsLobeIsACircle) {
  PlotOptions options;
  options.thetas = {40};
  Drawing drawing =
      draw_plot(PlotKind::polar, {material("diffuse", {{"reflectance", "0.5"}})}, options);
  const PlotLine* lobe = nullptr;
  for (const auto& item : drawing.items)
    if (auto* line = std::get_if<PlotLine>(&item))
      if (line->stroke.role == Ink::series && line->points.size() > 30)
        lobe = line;
  ASSERT_TRUE(lobe);
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const auto& p : lobe->points) {
    left = std::min(left, p.x), right = std::max(right, p.x);
    top = std::min(top, p.y), bottom = std::max(bottom, p.y);
  }
  double radius = (right - left) / 2;
  EXPECT_NEAR(bottom - top, 2 * radius, 0.3);
  for (const auto& p : lobe->points)
    EXPECT_NEAR(std::hypot(p.x - (left + right) / 2, p.y - (top + bottom) / 2), radius, 0.3);
  // The radius is 0.2 per sr at the rim, the lobe's height 0.5 / pi.
  double rim = 0;
  for (const auto& item : drawing.items)
    if (auto* line = std::get_if<PlotLine>(&item))
      if (line->stroke.role == Ink::text && line->points.size() == 2)
        rim = std::max(rim, (line->points[1].x - line->points[0].x) / 2);
  EXPECT_NEAR(2 * radius / rim, 0.5 / kPi / 0.2, 2e-3);
}

TEST(Plot, AlbedoOfLambertIsALevelLineAtItsReflectance) {
  Drawing drawing =
      draw_plot(PlotKind::albedo, {material("diffuse", {{"reflectance", "0.3"}})}, {});
  double zero = 0, one = 0; // where the ticks stand
  const PlotLine* curve = nullptr;
  for (const auto& item : drawing.items) {
    if (auto* label = std::get_if<PlotLabel>(&item)) {
      if (label->anchor == PlotLabel::end && label->text == "0")
        zero = label->at.y;
      if (label->anchor == PlotLabel::end && label->text == "1")
        one = label->at.y;
    } else if (auto* line = std::get_if<PlotLine>(&item)) {
      if (line->stroke.role == Ink::series)
        curve = line;
    }
  }
  ASSERT_TRUE(curve && zero > one);
  for (const auto& p : curve->points)
    EXPECT_NEAR((zero - 4.5 - p.y) / (zero - one), 0.3, 1e-3);
}

TEST(Plot, IdsAndThemes) {
  Drawing drawing = draw_plot(PlotKind::polar, {material("diffuse")}, {});
  std::string automatic = to_svg(drawing, "lobes");
  EXPECT_NE(automatic.find("<svg xmlns=\"http://www.w3.org/2000/svg\" id=\"lobes\""),
            std::string::npos);
  EXPECT_NE(automatic.find("prefers-color-scheme:dark"), std::string::npos);
  EXPECT_NE(automatic.find("#lobes .ft{fill:" + ink_colour({Ink::text}, true)), std::string::npos);
  std::string dark = to_svg(drawing, "lobes", PlotTheme::dark, 240);
  EXPECT_EQ(dark.find("<style>"), std::string::npos);
  EXPECT_NE(dark.find(ink_colour({Ink::background}, true)), std::string::npos);
  EXPECT_NE(dark.find("width=\"240\""), std::string::npos);
  EXPECT_EQ(to_svg(drawing), to_svg(drawing)); // made from the content
}

TEST(Plot, TextIsEscaped) {
  Drawing drawing;
  drawing.width = drawing.height = 100;
  drawing.title = "a < b & \"c\"";
  drawing.label({{5, 50}, "<&>\n\"", 12});
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(to_svg(drawing).c_str()));
  EXPECT_STREQ(document.child("svg").child("title").text().get(), "a < b & \"c\"");
  EXPECT_STREQ(document.child("svg").child("text").text().get(), "<&> \"");
}

std::string message(const std::vector<PlotMaterial>& materials, const PlotOptions& options) {
  try {
    draw_plot(PlotKind::polar, materials, options);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Plot, Errors) {
  PlotOptions options;
  EXPECT_NE(message({}, options).find("needs a material"), std::string::npos);
  EXPECT_NE(message(std::vector<PlotMaterial>(8, material("diffuse")), options).find("at most 7"),
            std::string::npos);
  options.thetas = {120};
  EXPECT_NE(message({material("diffuse")}, options).find("less than 90"), std::string::npos);
  options.thetas = {90};
  EXPECT_NE(message({material("dielectric")}, options).find("not 90"), std::string::npos);
  options.thetas = {NAN};
  EXPECT_NE(message({material("dielectric")}, options).find("0 to 180"), std::string::npos);
  options = {};
  options.inside = true;
  EXPECT_NE(message({material("diffuse")}, options).find("from inside"), std::string::npos);
  options = {};
  options.width = 100;
  EXPECT_NE(message({material("diffuse")}, options).find("300 to 4000"), std::string::npos);
  options.width = 480;
  options.height = 90;
  EXPECT_NE(message({material("diffuse")}, options).find("at least"), std::string::npos);
  EXPECT_THROW(plot_kind("polr"), Error);
}

// --- Pixels ---

double ink_of(const Image& image) { // how much black there is on white, in pixels
  double sum = 0;
  for (size_t i = 0; i < image.data.size(); i += 3)
    sum += 1 - image.data[i];
  return sum;
}

TEST(Pixels, CoverageIsTheArea) {
  Drawing square;
  square.width = square.height = 20;
  // Black is the ink of text over white, which is not quite black.
  double black = 1 - to_image(square, 20).data[0];
  EXPECT_EQ(black, 0);
  square.area({{3.25, 4.5}, {10.75, 4.5}, {10.75, 9.75}, {3.25, 9.75}}, {Ink::text});
  Image image = to_image(square, 20);
  double depth = 1 - image.at(5, 6, 0);
  EXPECT_GT(depth, 0.9);
  EXPECT_NEAR(ink_of(image) / depth, 7.5 * 5.25, 1e-3);
  EXPECT_NEAR(ink_of(to_image(square, 40)) / depth, 4 * 7.5 * 5.25, 1e-3);

  Drawing line;
  line.width = line.height = 40;
  line.line({{5, 7.3}, {35, 31}}, {Ink::text}, 2);
  double length = std::hypot(30, 23.7);
  EXPECT_NEAR(ink_of(to_image(line, 40)) / depth, 2 * length + kPi,
              0.03 * 2 * length); // round ends

  Drawing dashes;
  dashes.width = dashes.height = 60;
  dashes.line({{2, 30}, {24, 30}, {56, 30}}, {Ink::text}, 1, 1); // strokes of 7, gaps of 4
  double dashed = ink_of(to_image(dashes, 60)) / depth; // five strokes with half a disk at each end
  EXPECT_GT(dashed, 5 * 7);
  EXPECT_LT(dashed, 5 * (7 + 1.5));
}

TEST(Pixels, PicturesAreInterpolatedAndMixed) {
  Image two(2, 1, {"R", "G", "B", "A"}, 1);
  for (int c = 0; c < 3; ++c)
    two.at(0, 0, c) = 0;
  Drawing drawing;
  drawing.width = drawing.height = 16;
  drawing.items.emplace_back(PlotPicture{{0, 4}, {16, 8}, two});
  Image image = to_image(drawing, 16);
  EXPECT_NEAR(image.at(1, 8, 0), 0, 1e-6);
  EXPECT_NEAR(image.at(14, 8, 0), 1, 1e-6);
  EXPECT_NEAR(image.at(7, 8, 0) + image.at(8, 8, 0), 1, 1e-6); // around the middle
  EXPECT_EQ(image.at(1, 2, 0), 1);                             // above it
  std::get<PlotPicture>(drawing.items[0]).pixels.at(0, 0, 3) = 0;
  EXPECT_NEAR(to_image(drawing, 16).at(1, 8, 0), 1, 1e-6); // transparent
}

TEST(Pixels, PlotsHaveTheWidthAskedFor) {
  Drawing drawing = draw_plot(PlotKind::polar, {material("diffuse")}, {});
  for (PlotTheme theme : {PlotTheme::light, PlotTheme::dark}) {
    Image image = to_image(drawing, 333, theme);
    EXPECT_EQ(image.width, 333);
    EXPECT_NEAR(image.height, 333 * drawing.height / drawing.width, 1);
    EXPECT_EQ(image.at(0, 0, 0) > 0.5, theme == PlotTheme::light);
  }
}

} // namespace
