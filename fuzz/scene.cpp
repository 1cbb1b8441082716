// A whole scene: XML, plugins, and what is made of them up to the point where rays could start.

#include "formats/mitsuba_scene.h"
#include "scene_files.h"

#include <functional>

using namespace faceta;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Registry::global(); // what fails here is no fault of the input
  std::string_view text = fuzz::text_of(data, size);
  if (fuzz::leaves_its_folder(text))
    return -1;
  ReadOptions options;
  options.search_paths = {fuzz::scene_folder().path()};
  options.permissive = size % 2 != 0;
  options.warn = [](const std::string& warning) {
    fuzz::require(!warning.empty(), "a warning says something");
  };
  fuzz::accepts([&] {
    auto scene = read_mitsuba_scene_string(text, "scene.xml", options);
    // Embree's threads make this slow: one in eight shows as much.
    if (std::hash<std::string_view>()(text) % 8 != 0)
      return;
    try {
      scene->build(Isa::scalar);
      for (const SensorDesc& sensor : scene->sensors)
        scene->use_sensor(sensor.camera, sensor.film);
    } catch (const Error& error) {
      fuzz::require(!error.message().empty(), "an error has a message"); // places are the reader's
    }
  });
  return 0;
}
