#include "lanes_module/lane_functions.h"

extern "C" __attribute__((visibility("default"))) const faceta::test::LaneTable*
faceta_module_table() {
  return &faceta::test::LaneLoops<faceta::Lanes>::table();
}
