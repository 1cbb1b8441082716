#pragma once

/// The camera and pixel filter as the kernels read them.

#include "scene/scene.h"

namespace faceta {

/// Mitsuba 3.9.1's perspective camera: it looks along +z, +x points left in the picture, +y up.
/// Throws Error for angles, planes, sizes, crops or matrices that make no camera.
CameraView make_camera(const CameraDesc& camera, const FilmDesc& film);

/// A filter and its cumulated shares, which the view points into.
struct FilterTable {
  explicit FilterTable(const FilterDesc& desc);
  FilterView view() const;

  double radius = 0.5;
  int cells = 0;
  std::vector<float> share;
};

} // namespace faceta
