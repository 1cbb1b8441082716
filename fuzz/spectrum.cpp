// A spectrum: as an attribute and as a file, by both readers, and the colours it makes.

#include "formats/xml_values.h"
#include "fuzz.h"
#include "spectrum/spectrum_curve.h"

#include <cmath>

using namespace faceta;

namespace {

void to_colours(const SpectrumValue& spectrum) {
  for (auto use : {SpectrumUse::reflectance, SpectrumUse::unbounded, SpectrumUse::emission,
                   SpectrumUse::refractive_index}) {
    std::array<double, 3> rgb = spectrum_to_rgb(spectrum, use);
    for (double c : rgb)
      if (use == SpectrumUse::reflectance && std::holds_alternative<SpectrumCurve>(spectrum))
        fuzz::require(c >= 0 && c <= 1, "a reflectance lies between 0 and 1");
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::string_view text = fuzz::text_of(data, size);
  SourcePosition where{"scene.xml", 1, 1};
  SpectrumValue spectrum;
  if (fuzz::accepts([&] { spectrum = parse_spectrum(text, where); }))
    to_colours(spectrum);
  if (fuzz::accepts([&] { spectrum = parse_spectrum_text(text, "curve.spd"); }))
    to_colours(spectrum);
  xml::SpectrumValue read;
  auto check = [&] {
    fuzz::require(read.is_uniform() ? read.values.size() == 1
                                    : read.values.size() == read.wavelengths.size(),
                  "a value for each wavelength");
    read.is_regular();
  };
  if (fuzz::accepts([&] { read = xml::parse_spectrum(text, where); }))
    check();
  fuzz::MemoryFile file(text);
  if (fuzz::accepts([&] { read = xml::read_spectrum_file(file.path(), where, {}); }))
    check();
  return 0;
}
