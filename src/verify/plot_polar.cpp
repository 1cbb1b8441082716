#include "verify/plot_kinds.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta::plots {

namespace {

constexpr double kDegree = kPi / 180;
/// Decades of a logarithmic radius.
constexpr int kDecades = 4;
/// Lobes whose peaks differ by more are drawn with a logarithmic radius by default.
constexpr double kLogarithmicFrom = 20;
/// More lobes than these are only outlined.
constexpr size_t kMostFilled = 5;
/// Length of the arrow of a delta lobe of weight 1, as a share of the radius.
constexpr double kFullArrow = 0.84;

struct Lobe {
  const Series* series;
  double theta;
  std::vector<Vec2<double>> points; ///< angle and value; empty if there is only a delta
  std::vector<DeltaLobe> deltas;
  Ink ink;
  int dash;
};

class PolarPlot {
public:
  PolarPlot(const Materials& materials, const PlotOptions& options)
      : materials_(materials), options_(options), series_(series_of(materials, options)) {
    thetas_ = options.thetas;
    if (thetas_.empty())
      thetas_ =
          series_.size() == 1 ? std::vector<double>{0, 30, 60, 80} : std::vector<double>{0, 60};
    for (const PlotMaterial& m : materials)
      full_ |= passes_through(m.subject);
    for (double theta : thetas_)
      full_ |= theta > 90;
    compute();
  }

  Drawing draw() {
    PlotPage page = text();
    double rim = 26, radius = options_.width / 2 - 14 - rim;
    double natural = full_ ? 2 * radius + 2 * rim : radius + rim + 26;
    PlotBox box = begin_page(drawing_, page, options_.width, options_.height, natural);
    radius_ = std::min(box.width / 2 - rim, full_ ? box.height / 2 - rim : box.height - rim - 26);
    centre_ = {box.x + box.width / 2, full_ ? box.y + box.height / 2 : box.bottom() - 26};
    draw_web();
    for (const Lobe& lobe : lobes_)
      draw_lobe(lobe);
    draw_viewers();
    if (!any_values_ && !any_deltas_)
      draw_note(drawing_, {box.x, box.y, box.width, full_ ? box.height / 2 : box.height},
                "nothing is scattered in this plane");
    for (const Lobe& lobe : lobes_)
      for (const DeltaLobe& delta : lobe.deltas)
        label_delta(delta);
    label_radii();
    return std::move(drawing_);
  }

private:
  void compute() {
    double largest = 0, least = kInfinity;
    std::function<double(double)> identity = [](double v) { return v; };
    for (const Series& s : series_)
      for (size_t k = 0; k < thetas_.size(); ++k) {
        bool one = series_.size() == 1;
        Lobe lobe{
            &s, thetas_[k], {}, {}, one ? series_ink(int(k)) : s.ink, one ? 0 : series_dash(s, k)};
        const Subject& subject = s.material->subject;
        Vec3<double> wo = plot_viewer(lobe.theta, options_.phi);
        lobe.deltas = delta_lobes(subject, wo, s.channel);
        any_deltas_ |= !lobe.deltas.empty();
        if (!subject.traits().delta)
          lobe.points = polar_curve(subject, lobe.theta, options_.phi, s.channel, identity, 1e9);
        double peaks[2] = {0, 0}; // above and below
        for (const Vec2<double>& p : lobe.points)
          peaks[std::cos(p.x) < 0] = std::max(peaks[std::cos(p.x) < 0], p.y);
        for (double peak : peaks) {
          largest = std::max(largest, peak);
          if (peak > 0)
            least = std::min(least, peak);
        }
        lobes_.push_back(std::move(lobe));
      }
    any_values_ = largest > 0;
    bool logarithmic = options_.logarithmic.value_or(largest > kLogarithmicFrom * least);
    if (!any_values_)
      axis_ = linear_axis("", 0, 1, 4);
    else if (logarithmic)
      axis_ = logarithmic_axis("", largest * std::pow(10.0, -kDecades), largest, 6);
    else
      axis_ = linear_axis("", 0, largest, 5);
    // Again, now that it is known how large everything is drawn.
    std::function<double(double)> radius = [this](double v) { return axis_.position(v); };
    for (Lobe& lobe : lobes_)
      if (!lobe.points.empty())
        lobe.points = polar_curve(lobe.series->material->subject, lobe.theta, options_.phi,
                                  lobe.series->channel, radius, 7e-4);
  }

  int series_dash(const Series& s, size_t theta) const {
    return options_.colour == PlotColour::all ? s.dash : int(theta);
  }

  PlotPage text() const {
    PlotPage page = begin_text("Scattering lobes", materials_, options_);
    if (series_.size() == 1) {
      for (size_t k = 0; k < thetas_.size(); ++k)
        page.legend.push_back({viewer_text(k), series_ink(int(k)), 0});
    } else {
      for (const Series& s : series_)
        page.legend.push_back({s.label, s.ink, s.dash});
      if (options_.colour != PlotColour::all && thetas_.size() > 1)
        for (size_t k = 0; k < thetas_.size(); ++k)
          page.legend.push_back({viewer_text(k), {Ink::muted}, int(k)});
    }
    std::string how;
    if (any_values_)
      how = fmt::format("Radius: value (BSDF times cosine) in 1/sr{}. ",
                        axis_.logarithmic ? ", logarithmic" : "");
    if (any_deltas_)
      how += "Arrows: delta lobes, as long as their weight; " +
             fmt::format("a weight of 1 reaches {:.0f} % of the radius. ", 100 * kFullArrow);
    how += "Short arrows at the rim come from the viewer.";
    if (full_)
      how += " Without the factor 1/η² of radiance.";
    if (options_.phi != 0)
      how += fmt::format(" Azimuth {}°.", short_number(options_.phi));
    if (any_deltas_ && options_.caption)
      for (const Series& s : series_)
        page.caption.push_back(delta_text(s));
    std::erase(page.caption, "");
    explain(page, options_, how);
    return page;
  }

  /// Only the first says what the angle is of, so that a legend stays short.
  std::string viewer_text(size_t k) const {
    return (k == 0 ? "viewer at " : "") + short_number(thetas_[k]) + "°";
  }

  /// "dielectric: viewer at 0°: 0.04 reflected, 0.96 transmitted; ..."
  std::string delta_text(const Series& s) const {
    std::string text;
    for (const Lobe& lobe : lobes_) {
      if (lobe.series != &s || lobe.deltas.empty())
        continue;
      text += fmt::format("{}viewer at {}°:", text.empty() ? "" : "; ", short_number(lobe.theta));
      for (size_t i = 0; i < lobe.deltas.size(); ++i)
        text += fmt::format("{} {} {}", i ? "," : "", short_number(lobe.deltas[i].weight),
                            lobe.deltas[i].lobe == kReflection     ? "reflected"
                            : lobe.deltas[i].lobe == kTransmission ? "transmitted"
                                                                   : "straight through");
    }
    return text.empty()
               ? ""
               : "Delta weights" + (series_.size() > 1 ? " of " + s.label : "") + ", " + text + ".";
  }

  Vec2<double> place(double angle, double share) const {
    return {centre_.x + radius_ * share * std::sin(angle),
            centre_.y - radius_ * share * std::cos(angle)};
  }

  void draw_web() {
    double end = full_ ? kPi : kPi / 2;
    for (double tick : axis_.ticks) {
      double share = axis_.position(tick);
      if (share <= 0)
        continue;
      PlotPoints arc;
      for (int i = -36; i <= 36; ++i)
        arc.push_back(place(end * i / 36, share));
      drawing_.line(std::move(arc), {Ink::grid});
    }
    for (int degrees = -150; degrees <= 180; degrees += 30) {
      if (!full_ && std::abs(degrees) > 90)
        continue;
      drawing_.line({place(0, 0), place(degrees * kDegree, 1)}, {Ink::grid});
      if (degrees < 0 || std::abs(degrees) == 90)
        continue;
      Vec2<double> at = place(degrees * kDegree, 1 + 14 / radius_);
      drawing_.label(
          {{at.x, at.y + 4.5}, std::to_string(degrees) + "°", 12, PlotLabel::middle, {Ink::muted}});
    }
    drawing_.line({place(-kPi / 2, 1.0), place(kPi / 2, 1.0)}, {Ink::text}, 1.2);
  }

  void label_radii() {
    if (!any_values_)
      return;
    double y = centre_.y + 16, end = centre_.x;
    for (double tick : axis_.ticks) {
      double share = axis_.position(tick);
      double half = plot_text_width(short_number(tick), 12) / 2, at = centre_.x + radius_ * share;
      if (share <= 0 || at - half < end + 3) // no room beside the one before
        continue;
      end = at + half;
      drawing_.label(
          {{at, y}, short_number(tick), 12, PlotLabel::middle, {Ink::muted}, false, true});
    }
    if (!full_)
      drawing_.label(
          {{centre_.x - radius_, y}, "value in 1/sr", 12, PlotLabel::start, {Ink::muted}});
  }

  void draw_lobe(const Lobe& lobe) {
    PlotPoints outline;
    double largest = 0;
    for (const Vec2<double>& p : lobe.points) {
      double share = axis_.position(p.y);
      largest = std::max(largest, share);
      Vec2<double> at = place(p.x, share);
      // Stretches where nothing is scattered collapse into the centre.
      if (outline.empty() || std::hypot(at.x - outline.back().x, at.y - outline.back().y) > 0.02)
        outline.push_back(at);
    }
    if (largest > 0 && outline.size() > 2) {
      PlotLine line{std::move(outline), lobe.ink, 1.8, lobe.dash};
      if (lobes_.size() <= kMostFilled)
        line.fill = lobe.ink, line.opacity = 0.09;
      drawing_.items.emplace_back(std::move(line));
    }
    for (const DeltaLobe& delta : lobe.deltas)
      if (delta.weight > 0)
        draw_arrow(drawing_, centre_, tip(delta), lobe.ink, 2.2);
  }

  double angle_of(const DeltaLobe& delta) const {
    double x = delta.wi.x * std::cos(options_.phi * kDegree) +
               delta.wi.y * std::sin(options_.phi * kDegree);
    return std::atan2(x, delta.wi.z);
  }
  Vec2<double> tip(const DeltaLobe& delta) const {
    // Weak lobes keep an arrow that can be seen.
    return place(angle_of(delta), std::max(0.04, kFullArrow * std::min(delta.weight, 1.15)));
  }

  void label_delta(const DeltaLobe& delta) {
    double share = kFullArrow * delta.weight;
    if (share < 0.25)
      return;
    Vec2<double> at = place(angle_of(delta), std::min(share, 1.0) + 13 / radius_);
    drawing_.label({{at.x, at.y + 4.5},
                    short_number(delta.weight),
                    12,
                    PlotLabel::middle,
                    {Ink::text},
                    false,
                    true});
  }

  void draw_viewers() {
    bool one = series_.size() == 1;
    for (size_t k = 0; k < thetas_.size(); ++k) {
      double angle = -thetas_[k] * kDegree;
      Ink ink = one ? series_ink(int(k)) : Ink{Ink::text};
      draw_arrow(drawing_, place(angle, 1 + 1 / radius_), place(angle, 1 - 17 / radius_), ink, 1.8);
      if (thetas_[k] == 0 || thetas_[k] == 180)
        continue; // the web's own label stands there
      Vec2<double> at = place(angle, 1 + 14 / radius_);
      drawing_.label(
          {{at.x, at.y + 4.5}, short_number(thetas_[k]) + "°", 12, PlotLabel::middle, {Ink::text}});
    }
  }

  const Materials& materials_;
  const PlotOptions& options_;
  std::vector<Series> series_;
  std::vector<double> thetas_;
  std::vector<Lobe> lobes_;
  PlotAxis axis_;
  Drawing drawing_;
  Vec2<double> centre_;
  double radius_ = 0;
  bool full_ = false, any_values_ = false, any_deltas_ = false;
};

} // namespace

Drawing draw_polar(const Materials& materials, const PlotOptions& options) {
  return PolarPlot(materials, options).draw();
}

} // namespace faceta::plots
