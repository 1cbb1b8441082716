#include "formats/reflector.h"

#include "formats/material_docs.h"
#include "formats/measured_loader.h"
#include "materials/measured_demo.h"

#include <filesystem>

namespace faceta {

Reflector::Reflector(const Parameters& material)
    : model_(&material.model()), record_(material.record()) {
  const Traits& traits = model_->descriptor.traits;
  if (traits.has_delta)
    throw Error("'" + model_->name() + "' reflects into single directions, which no table holds",
                {}, "take a rough material");
  if (!(traits.lobes & kReflection))
    throw Error("'" + model_->name() + "' reflects nothing");
}

Reflector::Reflector(const MeasuredFile& file, const std::string& name)
    : model_(&Registry::global().get("measured")) {
  Parameters parameters(*model_);
  record_ = model_->make_record(parameters.slots(), parameters.choices(), {});
  auto tables = std::make_shared<FileTables>();
  tables->name = name;
  tables->values = measured_block(file, name);
  record_.file = std::move(tables);
}

Reflector find_reflector(const std::string& name, const Settings& settings) {
  if (find_scene_node(name))
    throw Error("'" + name + "' puts materials of a scene file together, it is no single model");
  if (Registry::global().find(name))
    return Reflector(make_parameters(name, settings));
  std::error_code ignored;
  if (!is_demo(name) && !std::filesystem::exists(name, ignored))
    throw Error("there is neither a file nor a material '" + name + "'", {},
                suggestion(name, Registry::global().names()));
  Settings all{{"filename", name}};
  all.insert(all.end(), settings.begin(), settings.end());
  return Reflector(make_parameters("measured", all));
}

std::array<double, 3> albedo(const Reflector& reflector, const Vec3<double>& wo, int n) {
  std::array<double, 3> sum{};
  for_samples(reflector, wo, n, [&](const Vec3<double>& wi, double pdf) {
    Color<double> value = reflector.value(wo, wi);
    for (int c = 0; c < 3; ++c)
      sum[size_t(c)] += value[c] / pdf / n;
  });
  return sum;
}

Vec3<double> direction_of(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

} // namespace faceta
