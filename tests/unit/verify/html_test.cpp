#include "verify/html.h"
#include "verify/plot_drawing.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace {

using namespace faceta;

TEST(Html, EscapesWhatMeansSomething) {
  EXPECT_EQ(html::escape("a<b & \"c\">d"), "a&lt;b &amp; &quot;c&quot;&gt;d");
  EXPECT_EQ(html::escape("η² → 1"), "η² → 1");
  EXPECT_EQ(html::escape("line\nline\ttab\x01\x7f"), "line\nline tab  ");
}

TEST(Html, ReplacesWhatIsNoUtf8) {
  const char* bad = "\uFFFD";
  EXPECT_EQ(html::escape("a\xff"
                         "b"),
            std::string("a") + bad + "b");
  // Cut short, overlong, a surrogate, beyond U+10FFFF: each byte for itself.
  EXPECT_EQ(html::escape("\xce"), bad);
  EXPECT_EQ(html::escape("\xc0\xaf"), std::string(bad) + bad);
  EXPECT_EQ(html::escape("\xe0\x80\xaf"), std::string(bad) + bad + bad);
  EXPECT_EQ(html::escape("\xed\xa0\x80"), std::string(bad) + bad + bad);
  EXPECT_EQ(html::escape("\xf4\x90\x80\x80"), std::string(bad) + bad + bad + bad);
  EXPECT_EQ(html::escape("\xf0\x9f\x94\xb6"), "\xf0\x9f\x94\xb6");
}

TEST(Html, SlugsAreLettersDigitsAndSingleHyphens) {
  EXPECT_EQ(html::slug("roughconductor/All normals"), "roughconductor-all-normals");
  EXPECT_EQ(html::slug("phong exponent=2.5"), "phong-exponent-2-5");
  EXPECT_EQ(html::slug("--a  é-"), "a");
  EXPECT_EQ(html::slug("<>"), "");
}

// The points of "m1 2l3-4.5.5 0z", as a browser reads relative coordinates.
std::vector<Vec2<double>> points_of(const std::string& path) {
  std::vector<double> numbers;
  std::string number;
  auto flush = [&] {
    if (!number.empty())
      numbers.push_back(std::stod(number));
    number.clear();
  };
  for (char c : path) {
    bool second_point = c == '.' && number.find('.') != std::string::npos;
    if (std::isdigit(static_cast<unsigned char>(c)) || (c == '.' && !second_point)) {
      number += c;
      continue;
    }
    flush();
    if (c == '-' || c == '.')
      number = c;
  }
  flush();
  std::vector<Vec2<double>> points;
  Vec2<double> at{0, 0};
  for (size_t i = 0; i + 1 < numbers.size(); i += 2) {
    at = {at.x + numbers[i], at.y + numbers[i + 1]};
    points.push_back(at);
  }
  return points;
}

TEST(PageTheme, ShortPathsGoThroughTheSamePoints) {
  Drawing drawing;
  drawing.width = drawing.height = 300;
  std::vector<Vec2<double>> line;
  for (int i = 0; i < 200; ++i) // far steps, near ones, whole numbers, both signs
    line.push_back({150 + (i % 7 ? 100 : 0.3) * std::sin(i * i * 0.37), 0.05 * i * (i % 3) - 10});
  drawing.line(line, series_ink(2), 1.5);
  std::string svg = to_svg(drawing, "x", PlotTheme::page);
  size_t begin = svg.rfind(" d=\"") + 4;
  std::vector<Vec2<double>> points = points_of(svg.substr(begin, svg.find('"', begin) - begin));
  ASSERT_GT(points.size(), 150u);
  size_t k = 0;
  for (const Vec2<double>& p : line) { // points that fall together are written once
    if (k + 1 < points.size() && std::hypot(points[k].x - p.x, points[k].y - p.y) > 0.0708)
      ++k;
    EXPECT_NEAR(points[k].x, p.x, 0.0501);
    EXPECT_NEAR(points[k].y, p.y, 0.0501);
  }
}

TEST(PageTheme, ColoursComeFromThePage) {
  Drawing drawing;
  drawing.width = drawing.height = 100;
  drawing.line({{0, 0}, {9, 9}}, series_ink(1));
  drawing.label({{5, 5}, "text"});
  std::string svg = to_svg(drawing, "x", PlotTheme::page);
  EXPECT_EQ(svg.find('#'), std::string::npos) << svg;
  EXPECT_EQ(svg.find("<style"), std::string::npos);
  std::string rules = page_plot_style();
  for (const char* ink_class : {".s1{stroke:#d55e00}", ".fb{fill:#ffffff}", ".ft{fill:#1f2328}"})
    EXPECT_NE(rules.find(ink_class), std::string::npos) << ink_class;
  std::string page = html::page("<t>", "<p>body</p>");
  EXPECT_NE(page.find(rules), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;t&gt;</title>"), std::string::npos);
}

} // namespace
