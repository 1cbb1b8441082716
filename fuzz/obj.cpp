#include "formats/mesh_obj.h"
#include "mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return faceta::fuzz::read_mesh(data, size, faceta::parse_obj);
}
