// A file of measured reflectance of any format, as it is and with the options that formats have.

#include "formats/measured_checks.h"
#include "formats/measured_reader.h"
#include "fuzz.h"

using namespace faceta;

namespace {

void read(std::string_view bytes, const MeasuredOptions& options) {
  MeasuredFile file;
  if (!fuzz::accepts([&] { file = parse_measured(bytes, "measured", options); }))
    return;
  std::string broken = unsound(file);
  fuzz::require(broken.empty(), broken.c_str());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::string_view bytes = fuzz::text_of(data, size);
  read(bytes, {});
  MeasuredOptions options;
  options.wavelength = 550;
  read(bytes, options);
  options = {};
  options.index = 2;
  read(bytes, options);
  options = {};
  options.merl_nodes = "edges";
  read(bytes, options);
  return 0;
}
