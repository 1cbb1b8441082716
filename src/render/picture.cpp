#include "render/picture.h"

#include "spectrum/cie.h"

namespace faceta {

namespace {

std::vector<std::string> format_channels(const std::string& format, bool& luminance, bool& xyz) {
  luminance = format.starts_with("luminance");
  xyz = format.starts_with("xyz");
  bool alpha = format == "rgba" || format == "xyza" || format == "luminance_alpha";
  std::vector<std::string> channels;
  if (luminance)
    channels = {"Y"};
  else if (xyz)
    channels = {"X", "Y", "Z"};
  else
    channels = {"R", "G", "B"};
  if (alpha)
    channels.push_back("A");
  return channels;
}

} // namespace

Image make_picture(const RenderResult& result, const FilmDesc& film,
                   const IntegratorDesc& integrator, const PictureFacts& facts) {
  const Film& sums = result.film;
  bool as_luminance = false, as_xyz = false;
  Image image;
  image.width = sums.width;
  image.height = sums.height;
  image.x = film.crop_x;
  image.y = film.crop_y;
  image.full_width = film.width;
  image.full_height = film.height;
  image.channels = format_channels(film.pixel_format, as_luminance, as_xyz);
  bool alpha = image.channels.back() == "A";
  bool moments = integrator.moments && !sums.xyz_squares.empty();
  if (moments)
    for (const char* prefix : {"", "m2_"})
      for (const char* axis : {".X", ".Y", ".Z"})
        image.channels.push_back(prefix + integrator.moment_name + axis);
  double scale = sums.samples ? 1.0 / double(sums.samples) : 0.0;
  image.data.reserve(size_t(sums.width) * sums.height * image.channels.size());
  for (size_t i = 0; i < size_t(sums.width) * sums.height; ++i) {
    const double* s = &sums.sums[4 * i];
    std::array<double, 3> rgb{s[0] * scale, s[1] * scale, s[2] * scale};
    std::array<double, 3> xyz = srgb_to_xyz(rgb);
    auto put = [&](double v) { image.data.push_back(static_cast<float>(v)); };
    if (as_luminance)
      put(luminance(rgb));
    else
      for (int k = 0; k < 3; ++k)
        put(as_xyz ? xyz[k] : rgb[k]);
    if (alpha)
      put(s[3] * scale);
    if (moments) {
      for (int k = 0; k < 3; ++k)
        put(xyz[k]);
      for (int k = 0; k < 3; ++k)
        put(sums.xyz_squares[3 * i + k] * scale);
    }
  }
  image.metadata["software"] = "Faceta " + facts.version;
  image.metadata["facetaVersion"] = facts.version;
  image.metadata["scene"] = facts.scene;
  image.metadata["command"] = facts.command;
  image.metadata["integrator"] = integrator.type;
  image.metadata["seed"] = static_cast<int>(facts.seed);
  image.metadata["spp"] = static_cast<int>(sums.samples);
  image.metadata["time"] = result.seconds;
  return image;
}

Image rgb_picture(const RenderResult& result) {
  Image all = result.film.image();
  return all.select({"R", "G", "B"});
}

} // namespace faceta
