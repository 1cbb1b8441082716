#include "formats/measured_reader.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace faceta {

const std::vector<MeasuredFormat>& measured_formats() {
  static const std::vector<MeasuredFormat> formats = {};
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
