#pragma once

/// Inside of plot.h: a function a kind, and what they share.

#include "verify/plot.h"
#include "verify/plot_chart.h"

namespace faceta::plots {

using Materials = std::vector<PlotMaterial>;

Drawing draw_polar(const Materials& materials, const PlotOptions& options);
Drawing draw_albedo(const Materials& materials, const PlotOptions& options);
Drawing draw_weight(const Materials& materials, const PlotOptions& options);
Drawing draw_slices(const Materials& materials, const PlotOptions& options);
Drawing draw_density(const Materials& materials, const PlotOptions& options);
Drawing draw_reciprocity(const Materials& materials, const PlotOptions& options);

/// A curve or a map each: a material seen through a channel.
struct Series {
  const PlotMaterial* material;
  PlotChannel channel;
  std::string label; ///< the material's, with the channel if there are several
  Ink ink;
  int dash;
};
std::vector<Series> series_of(const Materials& materials, const PlotOptions& options);

/// Title and the captions that every kind has: the parameters of each material.
PlotPage begin_text(const std::string& title, const Materials& materials,
                    const PlotOptions& options);
/// Adds how to read the plot in front of the parameters, if captions are wanted.
void explain(PlotPage& page, const PlotOptions& options, const std::string& text);

/// Cuts a box into cells for panels: as many columns as fit, filled row by row.
struct PanelGrid {
  PanelGrid(int count, double width, double smallest);
  int columns, rows;
  PlotBox cell(const PlotBox& box, int i) const;
};

} // namespace faceta::plots
