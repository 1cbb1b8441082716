// Scenes of several files: the input is cut at lines "---" into the scene and the files a.xml,
// b.xml, ... that it may include.

#include "formats/xml_tree.h"
#include "scene_files.h"

using namespace faceta;

namespace {

constexpr size_t kMaxFiles = 4;
constexpr std::string_view kCut = "\n---\n";

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::string_view rest = fuzz::text_of(data, size);
  if (fuzz::leaves_its_folder(rest))
    return -1;
  const fuzz::Folder& folder = fuzz::scene_folder();
  std::string_view scene = rest.substr(0, rest.find(kCut));
  for (size_t file = 0; file < kMaxFiles; ++file) {
    size_t cut = rest.find(kCut);
    rest.remove_prefix(cut == rest.npos ? rest.size() : cut + kCut.size());
    folder.write(std::string(1, char('a' + file)) + ".xml", rest.substr(0, rest.find(kCut)));
  }
  xml::ParseOptions options;
  options.search_paths = {folder.path()};
  options.permissive = size % 2 != 0;
  xml::NodePtr root;
  if (!fuzz::accepts([&] { root = xml::parse_scene_string(scene, "scene.xml", options); }))
    return 0;
  // What was read can be written, and reads as the same.
  std::string written = xml::write_xml(*root);
  std::string again = xml::write_xml(*xml::parse_scene_string(written, "written.xml", options));
  fuzz::require(written == again, "a written scene reads back as itself");
  return 0;
}
