// Parameters of a material as the command line gives them: the name of a model, then name=value, a
// line each.

#include "bsdf/registry.h"
#include "fuzz.h"

using namespace faceta;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Registry::global(); // what fails here is no fault of the input
  std::string_view text = fuzz::text_of(data, size);
  std::string model(text.substr(0, text.find('\n')));
  Settings settings;
  while (text.find('\n') != text.npos) {
    text.remove_prefix(text.find('\n') + 1);
    std::string_view line = text.substr(0, text.find('\n'));
    size_t equals = std::min(line.find('='), line.size());
    settings.emplace_back(line.substr(0, equals), line.substr(std::min(equals + 1, line.size())));
  }
  try {
    Parameters parameters = make_parameters(model, settings);
    parameters.record();
    Parameters again(parameters.model());
    for (const ParamInfo& p : parameters.descriptor().params)
      if (parameters.was_set(p.name))
        again.set(p.name, parameters.text(p.name));
    fuzz::require(again.slots() == parameters.slots() && again.choices() == parameters.choices(),
                  "text() reads back to the same numbers");
  } catch (const Error& error) {
    fuzz::require(!error.message().empty(), "an error has a message"); // there is no file
  }
  return 0;
}
