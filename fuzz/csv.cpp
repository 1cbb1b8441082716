// Tables of directions, through a material, to nowhere. The first byte chooses the command.

#include "formats/direction_table.h"
#include "fuzz.h"

using namespace faceta;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const ColumnMaterial material =
      column_material(make_parameters("roughconductor", {}), Isa::scalar);
  if (size == 0)
    return 0;
  fuzz::MemoryFile table(fuzz::text_of(data + 1, size - 1));
  auto run = data[0] == 's' ? sample_table : eval_table;
  fuzz::accepts([&] { run(material, table.path(), "/dev/null"); });
  return 0;
}
