#include "image/font.h"
#include "image/font_glyphs.h"
#include "support.h"

#include <cmath>

using namespace faceta;
using namespace faceta::test;

namespace {

/// Draws white on black and sums the coverage, with the bounds of what was drawn.
struct Drawn {
  double area = 0;
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
  Image image;
};

Drawn draw(std::string_view text, double height, double weight = 0.065, double x = 50,
           double y = 200) {
  Drawn out;
  out.image = Image(400, 300);
  draw_text(out.image, x, y, height, text, {1, 1, 1}, weight);
  for (int py = 0; py < 300; ++py)
    for (int px = 0; px < 400; ++px) {
      const float v = out.image.at(px, py, 0);
      EXPECT_TRUE(v >= 0 && v <= 1);
      out.area += double(v);
      if (v == 0)
        continue;
      out.left = std::min(out.left, px), out.right = std::max(out.right, px);
      out.top = std::min(out.top, py), out.bottom = std::max(out.bottom, py);
    }
  return out;
}

} // namespace

TEST(Font, StrokesHaveTheirArea) {
  // "l" is one upright stroke of 72 % of the size with half discs at its ends; "-" lies 22 % wide.
  for (double height : {20.0, 57.0, 150.0})
    for (double weight : {0.02, 0.065, 0.12}) {
      const double pen = weight * height, disc = M_PI / 4 * pen * pen;
      EXPECT_NEAR(draw("l", height, weight).area, pen * 0.72 * height + disc,
                  0.02 * pen * height + 0.3);
      EXPECT_NEAR(draw("-", height, weight).area, pen * 0.22 * height + disc,
                  0.02 * pen * height + 0.3);
    }
}

TEST(Font, CapitalsStandOnTheBaseLine) {
  const Drawn h = draw("H", 100, 0.06);
  EXPECT_NEAR(h.bottom, 200 + 3, 1.01);
  EXPECT_NEAR(h.top, 200 - 70 - 3, 1.01);
  EXPECT_GT(draw("p", 100).bottom, 215);
  EXPECT_LE(draw("gjpqy(|@", 100).bottom, 200 + 22 + 3);
}

TEST(Font, EveryAsciiCharacterAndSymbolIsDrawnAndDistinct) {
  std::vector<Image> seen;
  const auto add = [&](const std::string& text) {
    Drawn d = draw(text, 60);
    EXPECT_GT(d.area, 5) << text;
    for (const Image& other : seen)
      EXPECT_NE(other.data, d.image.data) << text;
    seen.push_back(std::move(d.image));
  };
  for (char c = '!'; c <= '~'; ++c)
    add(std::string(1, c));
  for (const char* symbol : {"σ", "α", "–", "°", "η", "κ", "±", "×", "²", "é", "ñ", "Å", "λ"})
    add(symbol);
  add("日"); // the box
  EXPECT_EQ(draw(" ", 60).area, 0);
  EXPECT_EQ(draw("日", 60).area, draw("\xff", 60).area);
}

TEST(Font, TableIsOrderedAndFitsItsWidths) {
  char32_t last = 0;
  for (const auto& glyph : font::glyphs()) {
    EXPECT_GT(glyph.code, last);
    last = glyph.code;
    EXPECT_GT(glyph.left + glyph.width + glyph.right, 0);
  }
  for (char c = '!'; c <= '~'; ++c) {
    if (c == 'j')
      continue; // its tail reaches to the left
    const double width = text_width(std::string(1, c), 100);
    const Drawn d = draw(std::string(1, c), 100, 0.02);
    EXPECT_GE(d.left, 50) << c;
    EXPECT_LE(d.right, 50 + width + 1) << c;
  }
}

TEST(Font, WidthsAddUpAndScale) {
  EXPECT_DOUBLE_EQ(text_width("AB", 40), text_width("A", 40) + text_width("B", 40));
  EXPECT_DOUBLE_EQ(text_width("σ = 0.5", 80), 2 * text_width("σ = 0.5", 40));
  EXPECT_EQ(text_width("111", 50), text_width("808", 50)); // figures line up in columns
  Image image(200, 50);
  EXPECT_NEAR(draw_text(image, 3.5, 40, 30, "abc", {1, 0, 0}), 3.5 + text_width("abc", 30), 1e-9);
}

TEST(Font, MixesColoursCutsAtTheEdgeAndWantsRgb) {
  Image image(20, 20, {"R", "G", "B", "A"}, 0.5f);
  draw_text(image, -5, 15, 2000, "####", {1, 0, 0.5f}, 0.5); // covers the whole image
  EXPECT_EQ(image.at(10, 10, 0), 1);
  EXPECT_EQ(image.at(10, 10, 1), 0);
  EXPECT_EQ(image.at(10, 10, 2), 0.5f);
  EXPECT_EQ(image.at(10, 10, 3), 1);
  const Image before = image;
  draw_text(image, 1e9, -1e9, 10, "gone", {0, 0, 0});
  EXPECT_EQ(image.data, before.data);
  Image grey(4, 4, {"Y"});
  EXPECT_THROW(draw_text(grey, 0, 4, 4, "x", {1, 1, 1}), Error);
}
