#include "formats/measured_reader.h"

#include "formats/measured_text_formats.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace faceta {

const std::vector<MeasuredFormat>& measured_formats() {
  static const std::vector<MeasuredFormat> formats = {
      // text and XML
      {"cornell", "Cornell gonioreflectometer (pbrt-v2 text)", is_cornell, read_cornell},
      {"astm", "ASTM E1392 (Cornell)", is_astm, read_astm},
      {"zemax", "Zemax tabular BSDF", is_zemax, read_zemax},
      {"lighttools", "LightTools BSDF", is_lighttools, read_lighttools},
      {"alta", "ALTA (Inria)", is_alta, read_alta},
      {"window_xml", "Radiance / LBNL Window BSDF XML", is_window_xml, read_window_xml},
      {"curet", "CUReT (Dana et al. 1999)", is_curet, read_curet},
      {"tvbrdf", "time-varying BRDF (Gu et al. 2006)", is_tvbrdf, read_tvbrdf},
      {"csv", "comma-separated values", is_brdf_csv, read_brdf_csv},
  };
  return formats;
}

MeasuredFile parse_measured(std::string_view bytes, const std::string& name,
                            const MeasuredOptions& options) {
  const std::vector<MeasuredFormat>& formats = measured_formats();
  auto found = std::find_if(formats.begin(), formats.end(),
                            [&](const MeasuredFormat& f) { return f.recognises(bytes); });
  if (found == formats.end()) {
    std::string known;
    for (const MeasuredFormat& f : formats)
      known += (known.empty() ? "" : ", ") + std::string(f.title);
    throw Error("not a file of measured reflectance that can be read", {name}, "known: " + known);
  }
  if (options.format != "auto" && options.format != found->name)
    throw Error(fmt::format("the file is of format '{}', not '{}'", found->name, options.format),
                {name}, "the format is told by the content; leave it out or say 'auto'");
  return found->read({bytes, name}, options);
}

MeasuredFile read_measured(const std::string& path, const MeasuredOptions& options) {
  return parse_measured(read_whole_file(path), path, options);
}

} // namespace faceta
