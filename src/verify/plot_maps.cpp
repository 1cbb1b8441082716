#include "verify/plot_kinds.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace faceta::plots {

namespace {

/// Colours over values from `least` to `largest`: from 0, or over decades if it is more than one.
PlotAxis colour_axis(const std::string& label, double least, double largest, bool logarithmic,
                     double decades) {
  if (!(largest > 0))
    return linear_axis(label, 0, 1, 4);
  // Within a decade or so the powers of ten would leave most colours unused.
  if (!logarithmic || largest < 30 * least)
    return linear_axis(label, 0, largest, 5);
  return logarithmic_axis(label, std::max(least, largest * std::pow(10.0, -decades)), largest, 6);
}

/// The density above which 99.9 % of the mass lies.
double density_that_matters(const std::vector<const HemisphereMap*>& maps) {
  std::vector<double> cells;
  double mass = 0, sum = 0;
  for (const HemisphereMap* map : maps)
    for (double c : map->cells)
      if (c > 0) {
        cells.push_back(c);
        mass += c;
      }
  std::sort(cells.rbegin(), cells.rend());
  for (double c : cells)
    if ((sum += c) >= 0.999 * mass)
      return c;
  return 0;
}

std::vector<double> shares(const std::vector<double>& values, const PlotAxis& axis) {
  std::vector<double> result;
  for (double v : values)
    result.push_back(std::isnan(v) ? v : axis.position(v));
  return result;
}

/// Heading of a panel; what does not fit is cut.
void heading(Drawing& drawing, PlotBox& cell, const std::string& text) {
  auto lines = wrap_text(text, 13, cell.width);
  for (const std::string& line : lines) {
    drawing.label({{cell.x + cell.width / 2, cell.y + 13}, line, 13, PlotLabel::middle});
    cell.y += 18, cell.height -= 18;
  }
}

PlotBox take_colour_bar(PlotBox& box) {
  PlotBox bar = box;
  box.height -= kColourBarHeight + 8;
  bar.y = box.bottom() + 8;
  bar.height = kColourBarHeight;
  double width = std::min(bar.width, 420.0);
  bar.x += (bar.width - width) / 2, bar.width = width;
  return bar;
}

} // namespace

namespace {

/// Square maps beside each other with one colour bar below.
struct SquareMaps {
  struct Map {
    std::string heading; ///< if there are several
    PlotAxis x, y;
    std::vector<double> values; ///< empty: a note instead
  };
  int cells;
  std::vector<Map> maps;
  PlotAxis colours;
  const char* nothing; ///< said instead of a map without values

  Drawing draw(const PlotPage& page, const PlotOptions& options) const {
    Drawing drawing;
    int count = int(maps.size());
    PanelGrid grid(count, options.width, 235);
    double side = std::min((options.width - 28 - 14 * (grid.columns - 1)) / grid.columns, 400.0);
    bool bar_wanted =
        std::any_of(maps.begin(), maps.end(), [](auto& m) { return !m.values.empty(); });
    double body =
        grid.rows * (side + 46) + 14 * (grid.rows - 1) + (bar_wanted ? kColourBarHeight + 8 : 0);
    PlotBox box = begin_page(drawing, page, options.width, options.height, body), bar;
    if (bar_wanted)
      bar = take_colour_bar(box);
    for (int i = 0; i < count; ++i) {
      PlotBox cell = grid.cell(box, i);
      if (count > 1)
        heading(drawing, cell, maps[i].heading);
      if (cell.width > cell.height + 20) // square, or nearly
        cell.x += (cell.width - cell.height - 20) / 2, cell.width = cell.height + 20;
      PlotPanel panel(drawing, cell, maps[i].x, maps[i].y, false);
      if (maps[i].values.empty())
        panel.note(nothing);
      else
        panel.picture(cells, cells, shares(maps[i].values, colours));
    }
    if (bar_wanted)
      draw_colour_bar(drawing, bar, colours);
    return drawing;
  }
};

/// Ticks of an axis of angles in one of `count` maps.
PlotAxis map_axis(const std::string& label, double high, int count) {
  return degree_axis(label, high, count > 1 ? 3 : 6);
}

} // namespace

Drawing draw_slices(const Materials& materials, const PlotOptions& options) {
  std::vector<Series> series = series_of(materials, options);
  SquareMaps plot{90, {}, {}, "no values: delta lobes or transmission only"};
  double largest = 0, least = std::numeric_limits<double>::infinity();
  int count = int(series.size());
  for (const Series& s : series) {
    std::vector<double> values =
        image_slice(s.material->subject, plot.cells, options.phi, s.channel);
    bool any = false;
    for (double v : values)
      if (v > 0)
        any = true, largest = std::max(largest, v), least = std::min(least, v);
    if (!any)
      values.clear();
    plot.maps.push_back({s.label, map_axis("half angle θh in degrees", 90, count),
                         map_axis("difference angle θd in degrees", 90, count), std::move(values)});
  }
  plot.colours = colour_axis("reflection in 1/sr, without the cosine", least, largest,
                             options.logarithmic.value_or(true), 5);
  PlotPage page = begin_text("Image slice", materials, options);
  explain(page, options,
          fmt::format("Columns: half vector from the normal (left) to the horizon; rows: light and "
                      "viewer together (below) to grazing (above). Azimuth between: 90°{}.",
                      options.phi != 0
                          ? fmt::format("; of the half vector: {}°", short_number(options.phi))
                          : ""));
  return plot.draw(page, options);
}

Drawing draw_reciprocity(const Materials& materials, const PlotOptions& options) {
  SquareMaps plot{60,
                  {},
                  logarithmic_axis("relative difference of both ways", 1e-16, 1, 8),
                  "no values: delta lobes only"};
  std::vector<Series> series = series_of(materials, {});
  std::string how = "Largest over azimuths and colours. Rounding leaves up to about 1e-12; only "
                    "what is far above is a fault or a trait of the model.";
  std::string figures;
  int count = int(series.size());
  for (const Series& s : series) {
    ReciprocityMap map = reciprocity_map(s.material->subject, plot.cells);
    if (s.material->subject.traits().delta)
      map.cells.clear();
    else
      figures += fmt::format("{}Largest{}: {:.1e}.", figures.empty() ? "" : " ",
                             count > 1 ? " of " + s.label : "", map.largest);
    plot.maps.push_back({s.label, map_axis("angle of a in degrees", map.high, count),
                         map_axis("angle of b in degrees", map.high, count), std::move(map.cells)});
  }
  PlotPage page = begin_text("Reciprocity", materials, options);
  if (options.caption && !figures.empty())
    page.caption.insert(page.caption.begin(), figures);
  explain(page, options, how);
  return plot.draw(page, options);
}

// --- Density ---

namespace {

/// One material from one angle: density and histogram of one hemisphere.
struct DensityRow {
  std::string label;
  HemisphereMap density, histogram;
  Vec3<double> wo;
  bool below;
  std::vector<DeltaLobe> deltas;
};

class DensityPlot {
public:
  DensityPlot(const Materials& materials, const PlotOptions& options)
      : materials_(materials), options_(options) {
    std::vector<double> thetas = options.thetas;
    if (thetas.empty())
      thetas = {60};
    for (const Series& s : series_of(materials, {}))
      for (double theta : thetas)
        add(s, theta, materials.size() > 1, thetas.size() > 1);
    page_ = text(thetas);
  }

  Drawing draw() {
    std::vector<const HemisphereMap*> maps;
    double largest = 0;
    for (const DensityRow& row : rows_) {
      maps.push_back(&row.density);
      for (double c : row.density.cells)
        largest = std::isnan(c) ? largest : std::max(largest, c);
    }
    PlotAxis colours = colour_axis("density in 1/sr", density_that_matters(maps), largest,
                                   options_.logarithmic.value_or(true), 4);
    double gap = 20, side = std::min((options_.width - 28 - gap) / 2, 320.0), head = 22;
    double body = 20 + double(rows_.size()) * (side + head) + (any_ ? kColourBarHeight + 16 : 0);
    PlotBox box = begin_page(drawing_, page_, options_.width, options_.height, body), bar;
    if (any_)
      bar = take_colour_bar(box);
    box.height -= 20;
    side = std::min(side, box.height / double(rows_.size()) - head);
    double left = box.x + (box.width - 2 * side - gap) / 2, right = left + side + gap;
    drawing_.label(
        {{left + side / 2, box.y + 13}, "density", 13, PlotLabel::middle, {Ink::text}, true});
    drawing_.label(
        {{right + side / 2, box.y + 13}, "samples", 13, PlotLabel::middle, {Ink::text}, true});
    double y = box.y + 20;
    for (const DensityRow& row : rows_) {
      drawing_.label(
          {{box.x + box.width / 2, y + 14}, row.label, 13, PlotLabel::middle, {Ink::muted}});
      draw_disk({left, y + head, side, side}, row, row.density, colours);
      draw_disk({right, y + head, side, side}, row, row.histogram, colours);
      y += side + head;
    }
    if (any_)
      draw_colour_bar(drawing_, bar, colours);
    return std::move(drawing_);
  }

private:
  void add(const Series& s, double theta, bool name, bool angle) {
    constexpr int kCells = 72;
    const Subject& subject = s.material->subject;
    Vec3<double> wo = plot_viewer(theta, options_.phi);
    std::vector<HemisphereMap> histograms = sample_maps(subject, wo, kCells, options_.samples, 1);
    std::vector<DeltaLobe> deltas = delta_lobes(subject, wo, PlotChannel::luminance);
    double mass = 0;
    for (bool below : {false, true}) {
      if (below != (wo.z < 0) && !passes_through(subject))
        continue;
      std::string label = below ? "below the surface" : "above the surface";
      if (angle)
        label = fmt::format("viewer at {}°, ", short_number(theta)) + label;
      if (name)
        label = s.label + ", " + label;
      rows_.push_back(
          {label, density_map(subject, wo, below, kCells), histograms[below], wo, below, deltas});
      mass += rows_.back().density.mass();
    }
    any_ |= mass > 0;
    double sampled = histograms[0].mass() + histograms[1].mass(), delta = 0;
    for (const DeltaLobe& l : deltas)
      delta += l.probability;
    std::string who = name ? s.label : "";
    if (angle)
      who += fmt::format("{}viewer at {}°", who.empty() ? "" : ", ", short_number(theta));
    std::string sum =
        fmt::format("Density integrates to {:.4f}, {:.4f} of the samples came", mass, sampled);
    if (delta > 0)
      sum += fmt::format(", delta lobes take {:.4f}", delta);
    if (mass + sampled == 0)
      sum = delta > 0 ? fmt::format("Delta lobes only, {:.4f} together", delta) : "No samples come";
    sums_.push_back((who.empty() ? "" : who + ": ") + sum + ".");
  }

  PlotPage text(const std::vector<double>& thetas) const {
    PlotPage page = begin_text("Sampling density", materials_, options_);
    if (thetas.size() == 1)
      page.subtitle += fmt::format(", viewer at {}°", short_number(thetas[0]));
    if (options_.caption)
      page.caption.insert(page.caption.begin(), sums_.begin(), sums_.end());
    explain(page, options_,
            fmt::format("Hemispheres in an equal-area projection, the normal in the middle; ring: "
                        "viewer, cross: mirror direction, dots: delta lobes with their "
                        "probability. {} samples.{}",
                        options_.samples,
                        options_.phi != 0 ? fmt::format(" Azimuth {}°.", short_number(options_.phi))
                                          : ""));
    return page;
  }

  /// Cells outside of the disk take the value of a neighbour inside: interpolation then meets no
  /// gap at the rim.
  static std::vector<double> spread(const HemisphereMap& map) {
    std::vector<double> cells = map.cells;
    auto take = [&](size_t to, int row, int column) {
      if (row >= 0 && row < map.n && column >= 0 && column < map.n && std::isnan(cells[to]))
        cells[to] = map.cells[size_t(row) * map.n + column];
    };
    for (int row = 0; row < map.n; ++row)
      for (int column = 0; column < map.n; ++column)
        for (int step = -1; step <= 1; step += 2) {
          take(size_t(row) * map.n + column, row, column + step);
          take(size_t(row) * map.n + column, row + step, column);
        }
    return cells;
  }

  /// The background over all of a square but the disk in it: one outline, in along a slit.
  void cover_corners(const Vec2<double>& centre, double radius) {
    double out = radius + 1;
    PlotPoints outline = circle(centre, radius);
    outline.push_back(outline.front());
    outline.push_back({centre.x + out, centre.y});
    for (auto [x, y] : {std::pair(1, -1), {-1, -1}, {-1, 1}, {1, 1}, {1, 0}})
      outline.push_back({centre.x + x * out, centre.y + y * out});
    drawing_.area(std::move(outline), {Ink::background});
  }

  void draw_disk(const PlotBox& box, const DensityRow& row, const HemisphereMap& map,
                 const PlotAxis& colours) {
    Vec2<double> centre{box.x + box.width / 2, box.y + box.height / 2};
    double radius = box.width / 2 - 2;
    if (any_) {
      drawing_.items.emplace_back(
          PlotPicture{{centre.x - radius, centre.y - radius},
                      {2 * radius, 2 * radius},
                      ramp_pixels(map.n, map.n, shares(spread(map), colours))});
      cover_corners(centre, radius);
    }
    PlotLine rim{circle(centre, radius), {Ink::muted}};
    rim.closed = true;
    drawing_.items.emplace_back(rim);
    auto place = [&](const Vec3<double>& w) {
      Vec2<double> p = project(w);
      return Vec2<double>{centre.x + radius * p.x, centre.y - radius * p.y};
    };
    // Marks stand out on every colour: dark below, light above.
    auto mark = [&](PlotLine line) {
      line.stroke = {Ink::text}, line.width = 4;
      drawing_.items.emplace_back(line);
      line.stroke = {Ink::background}, line.width = 1.8;
      drawing_.items.emplace_back(line);
    };
    if ((row.wo.z < 0) == row.below) {
      PlotLine ring{circle(place(row.wo), 5), {}};
      ring.closed = true;
      mark(ring);
      Vec2<double> m = place(reflect(row.wo));
      mark({{{m.x - 5, m.y}, {m.x + 5, m.y}}, {}});
      mark({{{m.x, m.y - 5}, {m.x, m.y + 5}}, {}});
    }
    for (const DeltaLobe& lobe : row.deltas) {
      if ((lobe.wi.z < 0) != row.below)
        continue;
      Vec2<double> at = place(lobe.wi);
      drawing_.area(circle(at, 5), series_ink(1));
      double side = at.x > centre.x + 0.5 * radius ? -1 : 1;
      drawing_.label({{at.x + side * 9, at.y - 7},
                      short_number(lobe.probability),
                      12,
                      side > 0 ? PlotLabel::start : PlotLabel::end,
                      {Ink::text},
                      false,
                      true});
    }
  }

  const Materials& materials_;
  const PlotOptions& options_;
  PlotPage page_;
  std::vector<DensityRow> rows_;
  std::vector<std::string> sums_;
  Drawing drawing_;
  bool any_ = false;
};

} // namespace

Drawing draw_density(const Materials& materials, const PlotOptions& options) {
  return DensityPlot(materials, options).draw();
}

} // namespace faceta::plots
