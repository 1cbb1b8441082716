// Uses the installed package as somebody else's project would; run.cmake compares what it prints.
#include <cstdio>
#include <faceta/bsdf/columns.h>

int main() {
  using namespace faceta;
  Parameters parameters(Registry::global().get("diffuse"));
  parameters.set("reflectance", "0.25,0.5,1");

  // One pair of directions in double precision, wo straight up.
  Eval<double> e = parameters.model().eval(parameters.record(), {{0, 0, 1}, {0.6, 0, 0.8}});
  std::printf("double: %.5f %.5f %.5f, pdf %.5f\n", e.value[0], e.value[1], e.value[2], e.pdf);

  // A hundred of them by the fastest kernel of this machine.
  EvalColumns columns(100);
  for (int i = 0; i < columns.count; ++i) {
    columns.wo[2][i] = 1;
    columns.wi[0][i] = 0.6f;
    columns.wi[2][i] = 0.8f;
  }
  column_material(parameters).eval(columns);
  std::printf("lanes: %.5f %.5f %.5f, pdf %.5f\n", columns.value[0][99], columns.value[1][99],
              columns.value[2][99], columns.pdf[99]);

  try {
    Registry::global().get("difuse");
  } catch (const Error& error) {
    std::puts(error.what());
  }
}
