#pragma once

#include <array>
#include <vector>

namespace faceta {

/// A direction to the viewer and one to the light, radians.
struct CuretDirections {
  double theta_o, phi_o, theta_i, phi_i;
};

/// The 205 pairs of directions of the CUReT measurements in the order of its tables (Dana et al.
/// 1999). They are those of its table of directions, to 1e-6: 55 orientations of the sample seen by
/// a camera 22.5 degrees beside the light, then by cameras at the multiples of that up to 157.5, as
/// long as the sample is seen at less than 84 degrees.
const std::array<CuretDirections, 205>& curet_directions();

} // namespace faceta
