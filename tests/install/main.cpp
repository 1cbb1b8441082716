// Uses the installed package as somebody else's project would; run.cmake compares what it prints.
#include <cstdio>
#include <faceta/bsdf/columns.h>

namespace faceta::consumer {
std::vector<Model> consumer_models();
}

namespace {

/// The project's own material in double precision and by every kernel that this machine runs.
void show_dust() {
  using namespace faceta;
  Registry::global().add(consumer::consumer_models(), MODULES, "consumer");
  Parameters dust(Registry::global().get("dust"));
  Eval<double> e = dust.model().eval(dust.record(), {{0, 0, 1}, {0.6, 0, 0.8}});
  std::printf("dust double: %.5f, pdf %.5f\n", e.value[1], e.pdf);
  for (int i = 0; i < kIsaCount; ++i) {
    auto isa = static_cast<Isa>(i);
    if (!isa_supported(isa))
      continue;
    EvalColumns columns(7);
    for (int k = 0; k < columns.count; ++k) {
      columns.wo[2][k] = 1;
      columns.wi[0][k] = 0.6f;
      columns.wi[2][k] = 0.8f;
    }
    column_material(dust, isa).eval(columns);
    std::printf("dust %s: %.5f, pdf %.5f\n", kIsaNames[i], columns.value[1][6], columns.pdf[6]);
  }
}

} // namespace

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

  show_dust();

  try {
    Registry::global().get("difuse");
  } catch (const Error& error) {
    std::puts(error.what());
  }
}
