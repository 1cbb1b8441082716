#include "scene/camera.h"

#include "image/image.h"
#include "scene/affine.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace faceta {

using namespace double3;

namespace {

constexpr int kStepsPerCell = 32;

void check_camera(const CameraDesc& camera, const FilmDesc& film) {
  check_affine(camera.to_world);
  for (int i = 0; i < 3; ++i) {
    Double3 c = column(camera.to_world, i);
    if (std::abs(dot(c, c) - 1) > 1e-3)
      throw Error("to_world of the camera holds a scale", {}, "rotate and move it only");
  }
  if (!(camera.x_fov > 0 && camera.x_fov < 180))
    throw Error("the camera's horizontal field of view must lie between 0 and 180 degrees");
  if (!(camera.near_clip > 0))
    throw Error("near_clip of the camera must be greater than 0");
  if (!(camera.far_clip > camera.near_clip))
    throw Error("near_clip of the camera must be smaller than far_clip");
  for (double x : camera.principal_point)
    if (!std::isfinite(x))
      throw Error("the camera's principal point offset is not finite");
  check_image_size(film.width, film.height);
}

/// Offset and size of the crop window along one axis.
std::pair<int, int> crop(int offset, int size, int full, const char* axis) {
  if (size == 0)
    size = full - offset;
  if (offset < 0 || size < 1 || size > full - offset)
    throw Error(std::string("the crop window leaves the film along ") + axis, {},
                "the film has " + std::to_string(full) + " pixels there");
  return {offset, size};
}

double filter_value(const FilterDesc& desc, double radius, double x) {
  if (desc.type == FilterType::tent)
    return std::max(0.0, 1 - std::abs(x) / radius);
  // Mitsuba's Gaussian is lowered so that it ends at exactly 0.
  double a = -0.5 / (desc.stddev * desc.stddev);
  return std::max(0.0, std::exp(a * x * x) - std::exp(a * radius * radius));
}

} // namespace

CameraView make_camera(const CameraDesc& camera, const FilmDesc& film) {
  check_camera(camera, film);
  CameraView view{};
  for (int i = 0; i < 12; ++i)
    view.to_world[i] = static_cast<float>(camera.to_world[i]);
  view.near_clip = static_cast<float>(camera.near_clip);
  view.far_clip = static_cast<float>(camera.far_clip);
  view.film_width = film.width;
  view.film_height = film.height;
  std::tie(view.crop_x, view.crop_width) = crop(film.crop_x, film.crop_width, film.width, "x");
  std::tie(view.crop_y, view.crop_height) = crop(film.crop_y, film.crop_height, film.height, "y");
  // The window on the near plane: its left edge is at +x, its top at +y.
  double x = camera.near_clip * std::tan(camera.x_fov * std::numbers::pi / 360);
  double y = x * film.height / film.width;
  double m[16] = {-2 * x, 0,      0, x * (1 - 2 * camera.principal_point[0]),
                  0,      -2 * y, 0, y * (1 - 2 * camera.principal_point[1]),
                  0,      0,      0, camera.near_clip,
                  0,      0,      0, 1};
  std::copy(m, m + 16, view.sample_to_camera);
  return view;
}

FilterTable::FilterTable(const FilterDesc& desc) {
  if (desc.type == FilterType::box) {
    share.assign(1, 1.0f);
    return;
  }
  bool tent = desc.type == FilterType::tent;
  radius = tent ? desc.radius : 4 * desc.stddev;
  if (!(radius > 0) || !std::isfinite(radius))
    throw Error(tent ? "the radius of the tent filter must be greater than 0"
                     : "stddev of the gaussian filter must be greater than 0");
  cells = kFilterCells;
  std::vector<double> sums{0};
  for (int i = 0; i < cells; ++i) {
    double cell = 0; // midpoint rule
    for (int k = 0; k < kStepsPerCell; ++k)
      cell += filter_value(desc, radius, radius * (i + (k + 0.5) / kStepsPerCell) / cells);
    sums.push_back(sums.back() + cell);
  }
  for (double sum : sums)
    share.push_back(static_cast<float>(sum / sums.back()));
}

FilterView FilterTable::view() const {
  return {static_cast<float>(radius), cells, share.data()};
}

} // namespace faceta
