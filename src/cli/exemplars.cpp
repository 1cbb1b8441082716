#include "cli/exemplars.h"

#include "formats/material_json.h"
#include "formats/material_xml.h"
#include "verify/properties.h"

namespace faceta::cli {

std::vector<SuiteSubject> node_subjects(const SceneNode& node) {
  return exemplar_subjects(node, [](const std::string& xml) { return parse_material(xml); });
}

void add_round_trips() {
  round_trips().emplace_back("xml", through_xml);
  round_trips().emplace_back("json", through_json);
  tree_round_trips().emplace_back(
      "xml", [](const MaterialNode& tree) { return parse_material(write_material(tree)); });
}

} // namespace faceta::cli
