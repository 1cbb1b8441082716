// One <bsdf>: to a tree of materials, to XML, and back to the same.

#include "formats/material_xml.h"
#include "scene_files.h"

using namespace faceta;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Registry::global(); // what fails here is no fault of the input
  std::string_view text = fuzz::text_of(data, size);
  if (fuzz::leaves_its_folder(text))
    return -1;
  ReadOptions options;
  options.search_paths = {fuzz::scene_folder().path()};
  Scene scene;
  std::shared_ptr<MaterialNode> material;
  if (!fuzz::accepts([&] {
        material = parse_material(text, "material.xml", &scene, options);
        scene.add_material(material);
      }))
    return 0;
  std::string written;
  try {
    written = write_material(*material);
  } catch (const Error&) {
    return 0; // it has a texture
  }
  std::string again = write_material(*parse_material(written, "written.xml"));
  fuzz::require(written == again, "a written material reads back as itself");
  return 0;
}
