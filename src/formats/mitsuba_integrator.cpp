#include "formats/mitsuba_reader.h"

#include <cmath>
#include <fmt/format.h>

namespace faceta::mitsuba {

namespace {

const std::vector<std::string> kCommonNames = {"hide_emitters", "timeout", "block_size",
                                               "samples_per_pass"};

void read_common(const xml::Node& node, IntegratorDesc& integrator) {
  integrator.hide_emitters = node.get_boolean("hide_emitters", false);
  integrator.timeout = node.get_float("timeout", -1);
  if (std::isnan(integrator.timeout))
    throw node.error_at("timeout", "'timeout' is not a number of seconds");
  // How the peer divides its work; the picture does not depend on it.
  node.get_integer64("block_size", 0, 0, UINT32_MAX);
  node.get_integer64("samples_per_pass", 0, 0, UINT32_MAX);
}

std::vector<std::string> with_common(std::vector<std::string> names) {
  names.insert(names.end(), kCommonNames.begin(), kCommonNames.end());
  return names;
}

} // namespace

IntegratorDesc Reader::read_integrator(const xml::Node& node) {
  if (node.type == "moment")
    return read_moment(node);
  if (node.type != "path" && node.type != "direct")
    throw unsupported_plugin(node, {"path", "direct", "moment"});
  IntegratorDesc integrator;
  integrator.type = node.type;
  read_common(node, integrator);
  if (node.type == "path") {
    integrator.max_depth = node.get_integer("max_depth", -1, -1);
    integrator.rr_depth = node.get_integer("rr_depth", 5, 1);
    finish(node, with_common({"max_depth", "rr_depth"}));
    return integrator;
  }
  const char* own = node.has("emitter_samples") ? "emitter_samples" : "bsdf_samples";
  if (node.has("shading_samples") && node.has(own))
    throw node.error_at(own, fmt::format("'shading_samples' and '{}' of {} exclude each other", own,
                                         node.describe()));
  constexpr int kMost = 1 << 20;
  int both = node.get_integer("shading_samples", 1, 0, kMost);
  integrator.emitter_samples = node.get_integer("emitter_samples", both, 0, kMost);
  integrator.bsdf_samples = node.get_integer("bsdf_samples", both, 0, kMost);
  if (integrator.emitter_samples + integrator.bsdf_samples == 0)
    throw node.error(node.describe() + " needs at least one sample of bsdfs or emitters");
  finish(node, with_common({"shading_samples", "emitter_samples", "bsdf_samples"}));
  return integrator;
}

/// Second moments of the one integrator inside, whose hide_emitters counts.
IntegratorDesc Reader::read_moment(const xml::Node& node) {
  IntegratorDesc outer;
  read_common(node, outer);
  std::vector<const xml::Property*> nested = node.object_properties("integrator");
  if (nested.empty())
    throw node.error(node.describe() + " needs an integrator inside");
  if (nested.size() > 1)
    throw Error("more than one integrator inside a moment integrator is not supported yet",
                nested[1]->where);
  xml::NodePtr child = nested[0]->object();
  if (child->type == "moment")
    throw child->error("a moment integrator inside another is not supported yet");
  IntegratorDesc integrator = read_integrator(*child);
  integrator.moments = true;
  integrator.moment_name = nested[0]->name;
  if (outer.timeout > 0)
    integrator.timeout = outer.timeout;
  finish(node, kCommonNames);
  return integrator;
}

} // namespace faceta::mitsuba
