#pragma once

#include "bsdf/file_tables.h"
#include "bsdf/measured_data.h"
#include "bsdf/registry.h"

namespace faceta {

/// Lets materials load files of measured reflectance (set_file_loader): what programs call once,
/// before they read scenes or make such materials.
///
/// A file stays in memory once while any material uses it, and is read again when it has changed.
/// Names of the form demo:NAME are tables made by Faceta itself (measured_demo.h).
void load_measured_files();

/// The options that the parameters of the models `measured` and `measuredwindow` give.
MeasuredOptions measured_options(const Parameters& parameters);

/// The name of the model that renders the file of that name or the demonstration, told from the
/// first bytes: `measuredwindow` for what transmits, `measured` for anything else, files that
/// cannot be read among it.
const char* model_of_measured(const std::string& name);

/// What people call a material on the command line: the name of a model, or of a measured file or
/// demonstration, which then becomes the `filename` of the model that reads it. Error with a
/// suggestion if it is neither.
struct NamedModel {
  const Model* model;
  Settings settings;
};
NamedModel model_or_file(const std::string& name, const Settings& settings);
/// Its parameters.
Parameters parameters_of(const NamedModel& named);

/// Reads the file of that name, or makes the demonstration.
MeasuredFile read_measured_or_demo(const std::string& name, const MeasuredOptions& options);

/// The numbers that the renderer reads (measured_table.h), of any kind of table. Error if the
/// renderer has none for it, with `name` as the place.
HugeVector<float> measured_block(const MeasuredFile& file, const std::string& name);

} // namespace faceta
