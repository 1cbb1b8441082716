#include "light_table.h"
#include "render/kernels/lights.h"
#include "render/kernels/surface.h"

namespace faceta::light_module {
namespace {

using T = Lanes;
using I = IntOf<T>;

Vec3<T> load3(const float* const (&a)[3], int i) {
  return {load<T>(a[0] + i), load<T>(a[1] + i), load<T>(a[2] + i)};
}
template <class V> void store3(float* const (&a)[3], int i, const V& v) {
  const T c[3] = {v.x, v.y, v.z};
  for (int k = 0; k < 3; ++k)
    store(a[k] + i, c[k]);
}
void store_mask(int32_t* out, const MaskOf<T>& m) {
  store(out, select(m, I(1), I(0)));
}

void sample(const SceneView& scene, const LightQueries& q, const LightAnswers& a, int n) {
  for (int i = 0; i < n; i += kWidthOf<T>) {
    Vec2<T> u{load<T>(q.u[0] + i), load<T>(q.u[1] + i)};
    LightPoint<T> s;
    with_lights<T>(scene, load_int<T>(q.light + i),
                   [&](const LightLanes<T>& l) { s = sample_light(scene, l, load3(q.p, i), u); });
    store3(a.offset, i, s.offset);
    store3(a.direction, i, s.direction);
    store(a.distance + i, s.distance);
    store(a.pdf + i, s.pdf);
    store_mask(a.valid + i, s.valid);
    store_mask(a.delta + i, s.delta);
  }
}

void pdf(const SceneView& scene, const LightQueries& q, const float* const (&offset)[3], float* pdf,
         int n) {
  for (int i = 0; i < n; i += kWidthOf<T>) {
    with_lights<T>(scene, load_int<T>(q.light + i), [&](const LightLanes<T>& l) {
      store(pdf + i, light_direction_pdf(l, load3(q.p, i), load3(offset, i), load3(q.normal, i)));
    });
  }
}

void choose(const SceneView& scene, const LightQueries& q, int32_t* light, float* probability,
            int n) {
  for (int i = 0; i < n; i += kWidthOf<T>) {
    LightChoice<T> c =
        choose_light(scene, load3(q.p, i), load3(q.normal, i), load<T>(q.choice + i));
    store(light + i, c.light);
    store(probability + i, c.probability);
  }
}

void probability(const SceneView& scene, const LightQueries& q, float* probability, int n) {
  for (int i = 0; i < n; i += kWidthOf<T>) {
    with_lights<T>(scene, load_int<T>(q.light + i), [&](const LightLanes<T>& l) {
      store(probability + i, light_probability(scene, l, load3(q.p, i), load3(q.normal, i),
                                               MaskOf<T>(l.depth >= I(0))));
    });
  }
}

void store_light(const EnvironmentAnswers& a, int i, const EnvironmentLight<T>& light) {
  store3(a.direction, i, light.direction);
  for (int k = 0; k < 3; ++k)
    store(a.radiance[k] + i, light.radiance[k]);
  store(a.pdf + i, light.pdf);
}

void sample_environment(const EnvironmentView& e, const LightQueries& q,
                        const EnvironmentAnswers& a, int n) {
  for (int i = 0; i < n; i += kWidthOf<T>) {
    Vec2<T> u{load<T>(q.u[0] + i), load<T>(q.u[1] + i)};
    Vec2<T> choice{load<T>(q.normal[0] + i), load<T>(q.normal[1] + i)};
    store_light(a, i,
                e.columns ? sample_environment_place(e, choose_environment_place<T>(e, choice, u))
                          : sample_constant_environment(e, u));
  }
}

void environment(const EnvironmentView& e, const EnvironmentAnswers& a, int n) {
  for (int i = 0; i < n; i += kWidthOf<T>) {
    Vec3<T> d{load<T>(a.direction[0] + i), load<T>(a.direction[1] + i),
              load<T>(a.direction[2] + i)};
    EnvironmentLight<T> light =
        e.columns ? environment_light(e, environment_spot(e, d)) : constant_environment<T>(e);
    light.direction = d;
    store_light(a, i, light);
  }
}

} // namespace
} // namespace faceta::light_module

extern "C" __attribute__((visibility("default"))) const faceta::light_module::LightTable*
faceta_module_table() {
  using namespace faceta::light_module;
  static const LightTable table{faceta::kWidthOf<faceta::Lanes>,
                                sample,
                                pdf,
                                choose,
                                probability,
                                sample_environment,
                                environment};
  return &table;
}
