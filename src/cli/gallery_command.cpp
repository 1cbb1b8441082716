#include "cli/commands.h"
#include "cli/gallery.h"
#include "image/io.h"

#include <cstdio>

namespace faceta::cli {

namespace {

namespace fs = std::filesystem;

Image render_sheet(const Gallery& gallery, const RenderOptions& options) {
  std::vector<SheetRow> rows;
  size_t total = 0, done = 0;
  for (const GalleryRow& row : gallery.rows)
    total += row.cells.size();
  for (const GalleryRow& row : gallery.rows) {
    SheetRow r{row.heading, row.note, {}};
    for (const GalleryCell& cell : row.cells) {
      r.cells.push_back(
          {cell.title, cell.label, render_cell(gallery, cell, *cell_material(cell), options)});
      if (options.verbosity >= 0)
        std::fprintf(stderr, "%2zu/%zu  %s, %s\n", ++done, total, cell.title.c_str(),
                     cell.label.c_str());
    }
    rows.push_back(std::move(r));
  }
  return compose_sheet(gallery.title, gallery.subtitle, rows, gallery.style);
}

} // namespace

int run_gallery(const RenderOptions& options) {
  for (const std::string& output : options.outputs)
    if (!can_write_image(output))
      throw Error("no writer for this ending", {output}, "known: .exr, .png, .pfm, .hdr");
  Gallery gallery = read_gallery();
  if (!options.measured.empty())
    show_measured(gallery, options.measured);
  Image sheet = render_sheet(gallery, options);
  for (const std::string& output : options.outputs) {
    if (fs::path(output).has_parent_path())
      fs::create_directories(fs::path(output).parent_path());
    write_image(output, sheet);
    std::printf("%s\n", fs::absolute(output).lexically_normal().c_str());
  }
  return kOk;
}

} // namespace faceta::cli
