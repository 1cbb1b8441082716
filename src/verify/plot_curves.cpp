#include "verify/plot_kinds.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta::plots {

namespace {

/// Closer where curves bend most.
constexpr double kAngles[] = {0,  10, 20, 30, 36, 42, 48, 54, 60, 65,   69,
                              73, 76, 79, 81, 83, 85, 86, 87, 88, 88.8, 89.5};
constexpr double kPanelHeight = 300;

double seen_from(double theta, const PlotOptions& options) {
  return options.inside ? 180 - theta : theta;
}

std::string viewer_text(const PlotOptions& options) {
  std::string text = options.inside ? " Seen from inside." : "";
  if (options.phi != 0)
    text += fmt::format(" Azimuth {}°.", short_number(options.phi));
  return text;
}

} // namespace

Drawing draw_albedo(const Materials& materials, const PlotOptions& options) {
  PlotPage page = begin_text("Directional albedo", materials, options);
  std::vector<Series> series = series_of(materials, options);
  bool transmits = false;
  for (const PlotMaterial& m : materials)
    transmits |= passes_through(m.subject);
  struct Curves {
    PlotPoints total, reflection, transmission;
  };
  std::vector<Curves> curves;
  double largest = 1;
  for (const Series& s : series) {
    Curves c;
    for (double theta : kAngles) {
      Vec3<double> wo = plot_viewer(seen_from(theta, options), options.phi);
      Albedo a = directional_albedo(s.material->subject, wo, s.channel);
      c.total.push_back({theta, a.total()});
      c.reflection.push_back({theta, a.reflection});
      c.transmission.push_back({theta, a.transmission});
      largest = std::max(largest, a.total());
    }
    curves.push_back(std::move(c));
    // Solid, dashed and dotted say what goes where if something is transmitted.
    page.legend.push_back({s.label, s.ink, transmits ? 0 : s.dash});
  }
  if (series.size() == 1)
    page.legend.clear();
  if (transmits) {
    Ink ink = series.size() == 1 ? series[0].ink : Ink{Ink::muted};
    page.legend.push_back({"both together", ink, 0});
    page.legend.push_back({"reflected", ink, 1});
    page.legend.push_back({"transmitted", ink, 2});
  }
  explain(page, options,
          "Share of the light of a white sphere that reaches the viewer; more than 1 (the line) "
          "would be energy out of nothing." +
              std::string(transmits ? " Without the factor 1/η² of radiance." : "") +
              viewer_text(options));
  Drawing drawing;
  PlotBox box = begin_page(drawing, page, options.width, options.height, kPanelHeight);
  // A hair above 1 is drawn on the line.
  PlotAxis y = linear_axis("albedo", 0, largest > 1.0005 ? largest : 1, 5);
  PlotPanel panel(drawing, box,
                  degree_axis("angle of the viewer from the normal in degrees", 90, 6), y);
  panel.curve({{0, 1}, {90, 1}}, {Ink::text}, 1.2);
  for (size_t i = 0; i < series.size(); ++i) {
    bool apart = passes_through(series[i].material->subject);
    panel.curve(curves[i].total, series[i].ink, 2.2, transmits ? 0 : series[i].dash);
    if (apart) {
      panel.curve(curves[i].reflection, series[i].ink, 1.6, 1);
      panel.curve(curves[i].transmission, series[i].ink, 1.6, 2);
    }
  }
  return drawing;
}

namespace {

struct WeightCurves {
  PlotPoints variation, mean, quantiles[5];
};

WeightCurves weight_curves(const Series& s, const PlotOptions& options) {
  constexpr int kSamples = 1 << 16;
  WeightCurves c;
  for (double theta : kAngles) {
    Vec3<double> wo = plot_viewer(seen_from(theta, options), options.phi);
    WeightStudy study = study_weights(s.material->subject, wo, s.channel, kSamples, 1);
    c.variation.push_back({theta, study.variation});
    c.mean.push_back({theta, study.mean});
    for (int k = 0; k < 5; ++k)
      c.quantiles[k].push_back({theta, study.quantiles[k]});
  }
  return c;
}

double highest(const PlotPoints& points) {
  double value = 0;
  for (const Vec2<double>& p : points)
    if (std::isfinite(p.y))
      value = std::max(value, p.y);
  return value;
}

void draw_distribution(PlotPanel& panel, const WeightCurves& c, Ink ink) {
  panel.band(c.quantiles[0], c.quantiles[4], ink, 0.18);
  panel.band(c.quantiles[1], c.quantiles[3], ink, 0.35);
  panel.curve(c.quantiles[2], ink, 1.4, 1);
  panel.curve(c.mean, {Ink::text}, 1.6);
}

} // namespace

Drawing draw_weight(const Materials& materials, const PlotOptions& options) {
  PlotPage page = begin_text("Weights of samples", materials, options);
  std::vector<Series> series = series_of(materials, options);
  std::vector<WeightCurves> curves;
  double largest = 0;
  for (const Series& s : series) {
    curves.push_back(weight_curves(s, options));
    largest = std::max(largest, highest(curves.back().variation));
    page.legend.push_back({s.label, s.ink, s.dash});
  }
  bool one = series.size() == 1;
  std::string how = "Coefficient of variation: standard deviation of the sample weight over its "
                    "mean; 0 would be perfect. 65536 samples at each angle.";
  if (one) {
    page.legend = {{"mean", {Ink::text}, 0}, {"median", series[0].ink, 1}};
    how += " Below: the weights themselves, half of them in the dark band, 98 % in the pale one.";
  }
  explain(page, options, how + viewer_text(options));
  Drawing drawing;
  PlotBox box = begin_page(drawing, page, options.width, options.height, one ? 438 : kPanelHeight);
  PlotAxis x = degree_axis("angle of the viewer from the normal in degrees", 90, 6);
  PlotBox upper = box, lower = box;
  PlotAxis upper_x = x;
  if (one) {
    upper.height = std::floor(box.height / 2) - 8;
    lower.y += upper.height + 8, lower.height -= upper.height + 8;
    upper_x.label.clear();
  }
  PlotPanel panel(drawing, upper, upper_x,
                  linear_axis("coefficient of variation", 0, std::max(largest, 0.1), 4));
  bool any = false;
  for (size_t i = 0; i < series.size(); ++i) {
    panel.curve(curves[i].variation, series[i].ink, 2.2, series[i].dash);
    for (const Vec2<double>& p : curves[i].variation)
      any |= std::isfinite(p.y);
  }
  if (!any)
    panel.note("every weight is 0");
  if (one) {
    double top = std::max({highest(curves[0].quantiles[4]), highest(curves[0].mean), 1e-6});
    PlotPanel weights(drawing, lower, x, linear_axis("weight", 0, top, 4));
    draw_distribution(weights, curves[0], series[0].ink);
  }
  return drawing;
}

} // namespace faceta::plots
