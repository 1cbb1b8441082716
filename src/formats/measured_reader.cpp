#include "formats/measured_reader.h"

#include "formats/measured_merl.h"
#include "formats/measured_readers.h"
#include "formats/measured_text_formats.h"

#include <algorithm>
#include <fmt/format.h>

namespace faceta {

const std::vector<MeasuredFormat>& measured_formats() {
  static const std::vector<MeasuredFormat> formats = {
      // Text, told by its words.
      {"cornell", "Cornell gonioreflectometer (pbrt-v2 text)", is_cornell, read_cornell},
      {"astm", "ASTM E1392 (Cornell)", is_astm, read_astm},
      {"zemax", "Zemax tabular BSDF", is_zemax, read_zemax},
      {"lighttools", "LightTools BSDF", is_lighttools, read_lighttools},
      {"alta", "ALTA (Inria)", is_alta, read_alta},
      {"klems", "Klems matrices (Radiance and LBNL Window XML)", is_klems, read_window_xml},
      {"tensortree", "tensor tree (Radiance XML)", is_tensor_tree, read_window_xml},
      {"curet", "CUReT (Dana et al. 1999)", is_curet, read_curet},
      {"tvbrdf", "time-varying BRDF (Gu et al. 2006)", is_tvbrdf, read_tvbrdf},
      {"csv", "comma-separated values", is_brdf_csv, read_brdf_csv},
      // Binary. Those without a first word come last: they are told by sizes that fit.
      {"pbsdf", "KAIST polarised BRDF (Baek et al. 2020)", is_pbsdf, read_pbsdf},
      {"rgl", "RGL adaptive parametrisation (Dupuy and Jakob 2018)", is_rgl, read_rgl},
      {"mbsdf", "NVIDIA MDL measured BSDF", is_mbsdf, read_mbsdf},
      {"ngan", "MIT anisotropic BRDF (Ngan et al. 2005)", is_ngan, read_ngan},
      {"merl", "MERL BRDF (Matusik et al. 2003)", is_merl, read_merl},
      {"utia", "UTIA BRDF (Filip and Vavra 2014)", is_utia, read_utia},
  };
  return formats;
}

namespace {

const MeasuredFormat* format_of(std::string_view bytes) {
  for (const MeasuredFormat& format : measured_formats())
    if (format.recognises(bytes))
      return &format;
  return nullptr;
}

// An option of one format only: one of its words, and the default for any other format.
void check_word(const std::string& option, const std::string& value,
                const std::vector<std::string>& known, const char* owner,
                const MeasuredFormat& format, const std::string& name) {
  if (std::find(known.begin(), known.end(), value) == known.end())
    throw Error(fmt::format("{} cannot be '{}'", option, value), {name}, suggestion(value, known));
  if (value != known.front() && std::string_view(format.name) != owner)
    throw Error(
        fmt::format("{} is for files of format '{}', this one is '{}'", option, owner, format.name),
        {name}, "leave it out");
}

} // namespace

MeasuredFile parse_measured(std::string_view bytes, const std::string& name,
                            const MeasuredOptions& options) {
  const MeasuredFormat* found = format_of(bytes);
  if (!found) {
    std::string known;
    for (const MeasuredFormat& f : measured_formats())
      known += (known.empty() ? "" : ", ") + std::string(f.title);
    throw Error("not a file of measured reflectance that can be read", {name}, "known: " + known);
  }
  if (options.format != "auto" && options.format != found->name)
    throw Error(fmt::format("the file is of format '{}', not '{}'", found->name, options.format),
                {name}, "the format is told by the content; leave it out or say 'auto'");
  check_word("merl_nodes", options.merl_nodes, {"centers", "edges"}, "merl", *found, name);
  check_word("utia_color", options.utia_color, {"scaled_srgb", "srgb", "linear"}, "utia", *found,
             name);
  MeasuredFile file = found->read({bytes, name}, options);
  file.info.format = found->name;
  file.info.title = found->title;
  return file;
}

MeasuredFile read_measured(const std::string& path, const MeasuredOptions& options) {
  MappedFile file(path);
  return parse_measured(file.bytes(), path, options);
}

std::string format_of_measured(const std::string& path) {
  try {
    MappedFile file(path);
    const MeasuredFormat* format = format_of(file.bytes());
    return format ? format->name : "";
  } catch (const Error&) {
    return {};
  }
}

} // namespace faceta
