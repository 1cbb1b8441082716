#include "verify/parameter_values.h"

#include <cmath>
#include <fmt/format.h>

namespace faceta {

std::string partner_of(const std::string& name) {
  const char* pairs[][2] = {{"alpha_u", "alpha_v"}, {"eta", "k"}};
  for (auto& pair : pairs)
    for (int i = 0; i < 2; ++i)
      if (name == pair[i])
        return pair[1 - i];
  return {};
}

bool lists(const std::string& comma_separated, const std::string& name) {
  return ("," + comma_separated + ",").find("," + name + ",") != std::string::npos;
}

double soft_value(const ParamInfo& p, double u) {
  double low = std::isfinite(p.soft.low) ? p.soft.low : 0;
  double high = std::isfinite(p.soft.high) ? p.soft.high : low + 4;
  return low + u * (high - low);
}

Parameters changed(const Model& model, const Exemplar& exemplar, const ParamInfo& p,
                   const std::string& text) {
  Parameters result(model);
  std::string partner = partner_of(p.name);
  for (const auto& [key, value] : exemplar.settings) {
    const ParamInfo* other = model.descriptor.find(key);
    bool clash =
        key == p.name || lists(p.excludes, key) || (other && lists(other->excludes, p.name));
    if (!clash)
      result.set(key, value);
  }
  const ParamInfo* other = model.descriptor.find(partner);
  if (other && !result.was_set(partner)) // not the default: beside eta = 0 no k has an effect
    result.set(partner, fmt::format("{}", soft_value(*other, 0.37)));
  result.set(p.name, text);
  result.check();
  return result;
}

} // namespace faceta
