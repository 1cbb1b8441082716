#pragma once

/// The pages of the documentation, as text.

#include "verify/subject_plots.h"

#include <string>
#include <vector>

namespace faceta::cli {

/// A picture of a material: beside the pages, in pictures/.
struct DocsPicture {
  std::string file; ///< its name there
  std::string title, label;
};

/// A model or a node of scene files.
struct DocsMaterial {
  const Descriptor* descriptor;
  const Model* model;    ///< null for a node
  const SceneNode* node; ///< null for a model
  std::vector<DocsPicture> pictures;
};

/// What was found out about the models: every exemplar verified and plotted.
struct DocsResults {
  SuiteReport report;
  std::vector<SubjectPlots> plots;
  std::string version; ///< of the program
};

/// A page is made of what the descriptors say, and of what was measured. The latter stands between
/// these marks and is missing without results.
inline constexpr const char* kMeasuredBegin = "<!--measured-->";
inline constexpr const char* kMeasuredEnd = "<!--/measured-->";
/// A line that begins so holds numbers, values of a parameter set, that may be off a little.
inline constexpr const char* kValuesBegin = "<!--values ";

std::vector<std::string> exemplar_names(const DocsMaterial& material);
/// "model/exemplar" of each parameter set of a material.
std::vector<std::string> exemplar_names(const DocsMaterial& material);
/// The page of one material, to stand in materials/. `results` may be null.
std::string material_page(const DocsMaterial& material, const DocsResults* results);
/// The first page. `results` may be null.
std::string index_page(const std::vector<DocsMaterial>& materials, const DocsResults* results);
/// The whole report card.
std::string report_page(const DocsResults& results);

} // namespace faceta::cli
