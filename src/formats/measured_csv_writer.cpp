#include "formats/measured_csv_writer.h"

#include "formats/measured_common.h"
#include "formats/output_file.h"

#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace faceta {

void write_measured_csv(const std::string& path, const MeasuredGrid& grid) {
  const bool relative = grid.coordinates == MeasuredCoordinates::relative;
  if (!relative && grid.coordinates != MeasuredCoordinates::absolute)
    throw Error("cannot write: a table of text holds grids over theta_i, phi_i, theta_o and phi_o",
                {path});
  const MeasuredAxis one{{0.0}};
  const MeasuredAxis &theta_i = grid.axes[0], &phi_i = relative ? one : grid.axes[1],
                     &theta_o = grid.axes[relative ? 1 : 2], &phi_o = grid.axes[relative ? 2 : 3];
  OutputFile file(path);
  std::string text = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
  const float* rgb = grid.rgb.data();
  for (double ti : theta_i.nodes)
    for (double pi : phi_i.nodes) {
      for (double to : theta_o.nodes)
        for (double po : phi_o.nodes) {
          if (!std::isnan(rgb[0]))
            fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g},{:.9g},{:.9g},{},{},{}\n",
                           ti / kDegree, pi / kDegree, to / kDegree, po / kDegree, rgb[0], rgb[1],
                           rgb[2]);
          rgb += 3;
        }
      file.write(text);
      text.clear();
    }
  file.commit();
}

} // namespace faceta
