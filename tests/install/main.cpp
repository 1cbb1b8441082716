// Uses the installed package as somebody else's project would; run.cmake compares what it prints.
#include <cstdio>
#include <faceta/base/error.h>

int main() {
  try {
    throw faceta::Error("unknown property", {"scene.xml", 3, 7},
                        faceta::suggestion("int_iro", {"int_ior", "ext_ior"}));
  } catch (const faceta::Error& error) {
    std::puts(error.what());
  }
}
