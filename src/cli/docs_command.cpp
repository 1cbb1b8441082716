#include "cli/commands.h"
#include "cli/docs_pages.h"
#include "cli/exemplars.h"
#include "cli/gallery.h"
#include "cli/suite_progress.h"
#include "formats/material_docs.h"
#include "formats/output_file.h"
#include "image/io.h"
#include "verify/html.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <set>
#include <sstream>

namespace faceta::cli {

namespace {

namespace fs = std::filesystem;

constexpr size_t kMostPictures = 3; ///< of a material
constexpr int kPictureSize = 176;

/// A picture to be made: of a cell of the gallery, or of a material that has none there.
struct PictureWish {
  DocsPicture picture;
  GalleryCell cell;
};

/// How the gallery shows the material; as an example with its defaults if it does not.
std::vector<PictureWish> picture_wishes(const Gallery& gallery, const Descriptor& d) {
  std::vector<PictureWish> wishes;
  auto add = [&](const GalleryCell& cell) {
    std::string file = fmt::format("{}-{}.png", html::slug(d.name), wishes.size() + 1);
    wishes.push_back({{file, cell.title, cell.label}, cell});
  };
  for (const GalleryRow& row : gallery.rows)
    for (const GalleryCell& cell : row.cells)
      if (wishes.size() < kMostPictures && cell_material(cell)->type == d.name)
        add(cell);
  if (wishes.empty() && !gallery.scenes.empty())
    add({d.title, "defaults", material_xml_snippet(d), gallery.rows.at(0).cells.at(0).scene,
         gallery.spp});
  return wishes;
}

struct Site {
  Gallery gallery = read_gallery();
  std::vector<DocsMaterial> materials;
  std::vector<PictureWish> pictures;

  Site() {
    for (const auto& model : Registry::global().models())
      add({&model->descriptor, model.get(), nullptr, {}});
    for (const SceneNode& node : scene_nodes())
      add({&node.descriptor, nullptr, &node, {}});
  }
  void add(DocsMaterial material) {
    for (PictureWish& wish : picture_wishes(gallery, *material.descriptor)) {
      material.pictures.push_back(wish.picture);
      pictures.push_back(std::move(wish));
    }
    materials.push_back(std::move(material));
  }

  /// Pairs of a path in the site and a text; without the report.
  std::vector<std::pair<fs::path, std::string>> pages(const DocsResults* results) const {
    std::vector<std::pair<fs::path, std::string>> list;
    list.emplace_back("index.html", index_page(materials, results));
    for (const DocsMaterial& m : materials)
      list.emplace_back(fs::path("materials") / (html::slug(m.descriptor->name) + ".html"),
                        material_page(m, results));
    return list;
  }
};

// --- Writing ---

DocsResults find_results(bool quiet) {
  add_round_trips();
  std::vector<SuiteSubject> subjects;
  std::vector<const Model*> models;
  for (const auto& model : Registry::global().models()) {
    models.push_back(model.get());
    for (SuiteSubject& s : exemplar_subjects(*model))
      subjects.push_back(std::move(s));
  }
  for (const SceneNode& node : scene_nodes())
    for (SuiteSubject& s : node_subjects(node))
      subjects.push_back(std::move(s));
  DocsResults results;
  results.version = FACETA_VERSION;
  SuiteOptions options;
  {
    SuiteProgressLine line(quiet);
    options.progress = [&](const SuiteProgress& p) { line.update(p); };
    results.report = run_suite(subjects, models, options);
  }
  SuiteProgressLine line(quiet, "plots");
  results.plots =
      draw_subject_plots(results.report.subjects, [&](const SuiteProgress& p) { line.update(p); });
  return results;
}

void write_file(const fs::path& path, std::string_view bytes) {
  fs::create_directories(path.parent_path());
  OutputFile file(path.string());
  file.write(bytes);
  file.commit();
}

void write_pictures(const Site& site, const fs::path& folder, bool quiet) {
  RenderOptions options;
  options.size = {kPictureSize, kPictureSize};
  size_t done = 0;
  for (const PictureWish& wish : site.pictures) {
    Image picture = render_cell(site.gallery, wish.cell, *cell_material(wish.cell), options);
    std::vector<std::uint8_t> png = encode_png(picture);
    write_file(folder / "pictures" / wish.picture.file,
               {reinterpret_cast<const char*>(png.data()), png.size()});
    if (!quiet)
      std::fprintf(stderr, "%2zu/%zu pictures  %s\n", ++done, site.pictures.size(),
                   wish.picture.file.c_str());
  }
}

/// Pages and pictures of the folder that the site does not have.
std::vector<fs::path> leftovers(const Site& site, const fs::path& folder) {
  std::set<fs::path> wanted = {folder / "report.html"};
  for (const DocsMaterial& m : site.materials)
    wanted.insert(folder / "materials" / (html::slug(m.descriptor->name) + ".html"));
  for (const PictureWish& wish : site.pictures)
    wanted.insert(folder / "pictures" / wish.picture.file);
  std::vector<fs::path> extra;
  for (const char* part : {"materials", "pictures"})
    if (fs::is_directory(folder / part))
      for (const auto& entry : fs::directory_iterator(folder / part))
        if (!wanted.count(entry.path()))
          extra.push_back(entry.path());
  std::sort(extra.begin(), extra.end());
  return extra;
}

int write_site(const Site& site, const fs::path& folder, bool quiet) {
  DocsResults results = find_results(quiet);
  for (const auto& [path, text] : site.pages(&results))
    write_file(folder / path, text);
  write_file(folder / "report.html", report_page(results));
  write_pictures(site, folder, quiet);
  for (const fs::path& path : leftovers(site, folder))
    std::fprintf(stderr, "%s belongs to no material\n", path.string().c_str());
  std::printf("%s\n", (fs::absolute(folder) / "index.html").lexically_normal().c_str());
  if (results.report.passed())
    return kOk;
  std::fprintf(stderr, "%zu checks failed: see the report\n",
               results.report.count(Verdict::failed));
  return kCheckFailed;
}

// --- Checking ---

std::optional<std::string> read_file(const fs::path& path) {
  constexpr std::uintmax_t kMost = 64u << 20;
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > kMost)
    return {};
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return file ? std::optional(text.str()) : std::nullopt;
}

/// Without what was measured. Whether each such part has a content.
bool cut_measured(std::string& text) {
  bool filled = true;
  size_t at = 0;
  while ((at = text.find(kMeasuredBegin, at)) != std::string::npos) {
    at += std::char_traits<char>::length(kMeasuredBegin);
    size_t end = text.find(kMeasuredEnd, at);
    if (end == std::string::npos)
      return false;
    filled = filled && end > at;
    text.erase(at, end - at);
  }
  return filled;
}

/// Numbers may differ by what rounding does to a mean over samples; other words may not.
bool same_values(const std::string& a, const std::string& b) {
  std::istringstream left(a), right(b);
  std::string x, y;
  while (true) {
    bool more = bool(left >> x), others = bool(right >> y);
    if (!more || !others)
      return more == others;
    char *x_end = nullptr, *y_end = nullptr;
    double u = std::strtod(x.c_str(), &x_end), v = std::strtod(y.c_str(), &y_end);
    bool number = x_end != x.c_str() && y_end != y.c_str();
    if (x != y && !(number && std::string(x_end) == y_end &&
                    std::abs(u - v) <= 1e-6 + 3e-3 * std::max(std::abs(u), std::abs(v))))
      return false;
  }
}

/// What is wrong with a page; empty if nothing is.
std::string difference(const std::optional<std::string>& there, const std::string& wanted) {
  if (!there)
    return "is missing";
  std::string text = *there;
  if (!cut_measured(text))
    return "lacks what is measured";
  if (text == wanted)
    return {};
  std::istringstream left(text), right(wanted);
  std::string a, b;
  for (int line = 1;; ++line) {
    bool more = bool(std::getline(left, a)), others = bool(std::getline(right, b));
    if (!more && !others)
      return {};
    if (more != others)
      return more ? "is too long" : "is cut short";
    bool close = b.starts_with(kValuesBegin) && same_values(a, b);
    if (a != b && !close)
      return fmt::format("is stale at line {}:\n  it says   {:.200}\n  should be {:.200}", line, a,
                         b);
  }
}

int check_site(const Site& site, const fs::path& folder) {
  std::vector<std::string> complaints;
  auto complain = [&](const fs::path& path, const std::string& what) {
    complaints.push_back((folder / path).string() + " " + what);
  };
  for (const auto& [path, text] : site.pages(nullptr))
    if (std::string what = difference(read_file(folder / path), text); !what.empty())
      complain(path, what);
  for (const PictureWish& wish : site.pictures)
    if (!fs::exists(folder / "pictures" / wish.picture.file))
      complain(fs::path("pictures") / wish.picture.file, "is missing");
  for (const fs::path& path : leftovers(site, folder))
    complaints.push_back(path.string() + " belongs to no material");
  std::string report = read_file(folder / "report.html").value_or("");
  for (const DocsMaterial& m : site.materials)
    for (const std::string& name : exemplar_names(m))
      if (report.find(html::element("b", name)) == std::string::npos)
        complain("report.html", "lacks " + name);
  for (const std::string& line : complaints)
    std::printf("%s\n", line.c_str());
  if (complaints.empty())
    return kOk;
  std::printf("%zu complaints; `make docs` writes the pages anew\n", complaints.size());
  return kCheckFailed;
}

} // namespace

int run_docs(const DocsOptions& options) {
  Site site;
  return options.check ? check_site(site, options.folder)
                       : write_site(site, options.folder, options.quiet);
}

} // namespace faceta::cli
