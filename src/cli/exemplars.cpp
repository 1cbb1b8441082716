#include "cli/exemplars.h"

#include "formats/material_json.h"
#include "formats/material_xml.h"
#include "verify/properties.h"

namespace faceta::cli {

std::vector<SuiteSubject> node_subjects(const SceneNode& node) {
  std::vector<SuiteSubject> subjects;
  for (const auto& [name, xml] : node.exemplars)
    subjects.push_back(tree_subject(node, name, *parse_material(xml)));
  return subjects;
}

void add_round_trips() {
  round_trips().emplace_back("xml", through_xml);
  round_trips().emplace_back("json", through_json);
  tree_round_trips().emplace_back(
      "xml", [](const MaterialNode& tree) { return parse_material(write_material(tree)); });
}

} // namespace faceta::cli
