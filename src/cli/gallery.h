#pragma once

/// The gallery's file: scenes with one object whose material is replaced, and the materials to
/// show.

#include "cli/render_command.h"
#include "formats/xml_tree.h"
#include "image/contact_sheet.h"

#include <filesystem>
#include <map>

namespace faceta::cli {

struct GalleryCell {
  std::string title, label;
  std::string bsdf;  ///< XML text of the material
  std::string scene; ///< name of one of Gallery::scenes
  int spp = 64;
};

struct GalleryRow {
  std::string heading, note;
  std::vector<GalleryCell> cells;
};

struct Gallery {
  struct View {
    std::filesystem::path file;
    double exposure = 0; ///< stops
  };
  std::string title, subtitle;
  std::string material_id; ///< of the bsdf in the scenes that gives way
  std::map<std::string, View> scenes;
  int cell_width = 0, cell_height = 0, spp = 0;
  SheetStyle style;
  std::vector<GalleryRow> rows;
};

/// Reads gallery.json of $FACETA_SCENES, share/faceta/scenes beside an installed library, or the
/// source tree of a build. Error if there is none or it is malformed.
Gallery read_gallery();

/// Shows files of measured reflectance in its rows instead.
void show_measured(Gallery& gallery, const std::vector<std::string>& files);

/// The <bsdf> of a cell.
xml::NodePtr cell_material(const GalleryCell& cell);

/// The object with a material, linear R, G, B.
/// \param options size, samples, seed, threads, instruction set and exposure, where they are given
Image render_cell(const Gallery& gallery, const GalleryCell& cell, const xml::Node& material,
                  const RenderOptions& options);

} // namespace faceta::cli
