#pragma once

/// What the commands prove, measure and document.

#include "verify/suite.h"

namespace faceta::cli {

/// Trees with this node at the root.
std::vector<SuiteSubject> node_subjects(const SceneNode& node);

/// XML and JSON, for the property round_trip. To be called once.
void add_round_trips();

} // namespace faceta::cli
