#include "verify/fit_kernels.h"

#include "base/jet.h"
#include "bsdf/model.h"
#include "materials/blinnphong.h"
#include "materials/diffuse.h"
#include "materials/hazygloss.h"
#include "materials/orennayar.h"
#include "materials/phong.h"
#include "materials/roughconductor.h"
#include "materials/roughplastic.h"
#include "materials/ward.h"

namespace faceta {

namespace {

template <class T> Vec3<T> convert(const Vec3<double>& v) {
  return {T(v.x), T(v.y), T(v.z)};
}

/// The model of a record and slots, with derivatives for active[first], active[first + 1] ...
template <template <class> class M, class T>
M<T> load(const Record& record, const std::vector<double>& slots, const std::vector<int>& active,
          size_t first, size_t width) {
  M<T> m;
  MaterialArgs args = record.args();
  RecordLoader<M<T>, T, const int32_t*> loader(m, args, args.choices, 0);
  M<T>::describe(loader);
  FieldPointers<M<T>, T> pointers(m);
  M<T>::describe(pointers);
  for (size_t i = 0; i < slots.size(); ++i)
    if (pointers.fields[i])
      *pointers.fields[i] = T(slots[i]);
  if constexpr (!std::is_same_v<T, double>)
    for (size_t k = 0; k < width && first + k < active.size(); ++k)
      pointers.fields[size_t(active[first + k])]->v[int(k)] = 1;
  if constexpr (requires { m.prepare(); })
    m.prepare();
  return m;
}

/// The value of eval(), without the density where the model offers that.
template <class T, class M>
Color<T> value_of(const M& m, const Vec3<double>& wo, const Vec3<double>& wi) {
  if constexpr (requires(const Vec3<T>& w) { m.value(w, w); })
    return m.value(convert<T>(wo), convert<T>(wi));
  else
    return m.eval(convert<T>(wo), convert<T>(wi), {}).value;
}

/// N derivatives a pass: as many as the model usually wants.
template <template <class> class M, int N>
void evaluate(const Record& record, const std::vector<double>& slots,
              const std::vector<int>& active, std::span<const FitRow> rows, double* values,
              double* derivatives) {
  if (!derivatives) {
    M<double> m = load<M, double>(record, slots, active, 0, 0);
    for (size_t i = 0; i < rows.size(); ++i) {
      Color<double> value = value_of<double>(m, rows[i].wo, rows[i].wi);
      for (int c = 0; c < 3; ++c)
        values[3 * i + size_t(c)] = value[c];
    }
    return;
  }
  using J = Jet<double, N>;
  size_t n = active.size();
  for (size_t first = 0; first == 0 || first < n; first += N) {
    M<J> m = load<M, J>(record, slots, active, first, N);
    for (size_t i = 0; i < rows.size(); ++i) {
      Color<J> value = value_of<J>(m, rows[i].wo, rows[i].wi);
      for (int c = 0; c < 3; ++c) {
        size_t at = 3 * i + size_t(c);
        values[at] = value[c].a;
        for (size_t k = 0; k < N && first + k < n; ++k)
          derivatives[at * n + first + k] = value[c].v[int(k)];
      }
    }
  }
}

} // namespace

FitKernel find_fit_kernel(const std::string& model) {
  static const std::pair<const char*, FitKernel> kKernels[] = {
      {"diffuse", evaluate<Diffuse, 4>},
      {"orennayar", evaluate<OrenNayar, 4>},
      {"phong", evaluate<Phong, 8>},
      {"blinnphong", evaluate<BlinnPhong, 8>},
      {"ward", evaluate<Ward, 8>},
      {"roughconductor", evaluate<RoughConductor, 8>},
      {"roughplastic", evaluate<RoughPlastic, 8>},
      {"hazygloss", evaluate<HazyGloss, 28>}};
  for (const auto& [name, kernel] : kKernels)
    if (model == name)
      return kernel;
  return nullptr;
}

} // namespace faceta
