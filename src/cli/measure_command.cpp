#include "cli/measure_command.h"

#include "cli/commands.h"
#include "formats/measured_loader.h"
#include "formats/measured_report.h"
#include "formats/reflector.h"

#include <algorithm>
#include <cstdio>

namespace faceta::cli {

namespace {

/// Only what says how a file is read: the rest would change nothing here.
MeasuredOptions reading_options(const Settings& settings) {
  const std::vector<std::string> known = {"format", "merl_nodes", "utia_color", "index",
                                          "wavelength"};
  for (const auto& [name, value] : settings)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error("'" + name + "' does not say how a file is read", {}, suggestion(name, known));
  return measured_options(make_parameters("measured", settings));
}

} // namespace

int run_measure_info(const MeasureInfoOptions& options) {
  std::string text;
  for (const MeasureInfoOptions::File& file : options.files) {
    MeasuredFile data = read_measured_or_demo(file.name, reading_options(file.settings));
    MeasuredAudit audit = audit_measured(data, file.name);
    text += options.json ? (text.empty() ? "" : ",\n") + measured_json(file.name, data.info, audit)
                         : measured_text(file.name, data.info, audit);
    if (options.repair.empty())
      continue;
    ConvertOptions output = options.output;
    output.description = data.info.description;
    Repaired mended = repaired(std::move(data), file.name, options.how);
    Conversion made = write_reflectance(options.repair, mended.value, output);
    made.notes.insert(made.notes.begin(), mended.notes.begin(), mended.notes.end());
    text += options.json ? ",\n" + conversion_json(options.repair, made)
                         : conversion_text(options.repair, made);
  }
  bool several = options.files.size() > 1 || !options.repair.empty();
  if (options.json)
    text = several ? "[" + text + "]\n" : text + "\n";
  std::fputs(text.c_str(), stdout);
  return kOk;
}

int run_measure_convert(const MeasureConvertOptions& options) {
  const Reflector source = find_reflector(options.source, options.settings);
  ConvertOptions output = options.output;
  output.description = options.source;
  for (const auto& [name, value] : options.settings)
    output.description += " " + name + "=" + value;
  Conversion made = write_reflectance(
      options.target,
      [&](const Vec3<double>& wo, const Vec3<double>& wi) { return source.value(wo, wi); }, output);
  if (source.transmits())
    made.notes.push_back("what goes through the surface is left out");
  std::string text = options.json ? conversion_json(options.target, made) + "\n"
                                  : conversion_text(options.target, made);
  std::fputs(text.c_str(), stdout);
  return kOk;
}

} // namespace faceta::cli
