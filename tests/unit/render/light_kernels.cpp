#include "light_kernels.h"

#include "materials/builtin.h"

#include <cmath>
#include <cstring>
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <stdexcept>

using namespace faceta;
using namespace faceta::double3;

namespace test {

namespace {

ShapeDesc lamp(Scene& scene) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(Registry::global().get("diffuse"));
  ShapeDesc shape;
  shape.material = scene.add_material(node);
  shape.emitter = std::make_shared<AreaEmitter>();
  shape.emitter->radiance.value = {1, 1, 1};
  return shape;
}

LoneLight new_light(const char* name) {
  LoneLight l;
  l.name = name;
  l.scene = std::make_shared<Scene>();
  return l;
}

ToWorld columns(const Double3& a, const Double3& b, const Double3& c, const Double3& o) {
  ToWorld m = kIdentityToWorld;
  for (int k = 0; k < 3; ++k) {
    m[4 * k] = a[k];
    m[4 * k + 1] = b[k];
    m[4 * k + 2] = c[k];
    m[4 * k + 3] = o[k];
  }
  return m;
}

Double3 combine(const Double3& o, const Double3& a, double s, const Double3& b, double t) {
  return add(o, add(scale(a, s), scale(b, t)));
}

double turn(double y, double x) {
  double phi = std::atan2(y, x) / (2 * kPi);
  return phi < 0 ? phi + 1 : phi;
}

} // namespace

const std::vector<const faceta::light_module::LightTable*>& light_tables() {
  static const auto tables = [] {
    std::vector<const faceta::light_module::LightTable*> result;
    for (int i = 0; i < kIsaCount; ++i) {
      if (!isa_supported(static_cast<Isa>(i)))
        continue;
      std::string path = std::string(FACETA_LIGHT_MODULES) + "/lights_" + kIsaNames[i] + ".so";
      void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
      if (!handle)
        throw std::runtime_error(dlerror());
      using Entry = const faceta::light_module::LightTable* (*)();
      result.push_back(reinterpret_cast<Entry>(dlsym(handle, "faceta_module_table"))());
    }
    return result;
  }();
  return tables;
}

Queries::Queries(int n) : count(n) {
  for (auto* vectors : {&p, &normal})
    for (std::vector<float>& v : *vectors)
      v.assign(n, 0);
  u[0].assign(n, 0.5f);
  u[1].assign(n, 0.5f);
  choice.assign(n, 0.5f);
  light.assign(n, 0);
}

void Queries::put_point(int i, const Double3& point, const Double3& n) {
  for (int k = 0; k < 3; ++k) {
    p[k][i] = static_cast<float>(point[k]);
    normal[k][i] = static_cast<float>(n[k]);
  }
}

void Queries::put_all(const Double3& point, const Double3& n, int l) {
  for (int i = 0; i < count; ++i)
    put_point(i, point, n);
  light.assign(count, l);
}

void Queries::random(std::mt19937& generator, bool normals) {
  auto number = [&] { return static_cast<float>(generator() >> 8) * 0x1p-24f; };
  for (int i = 0; i < count; ++i) {
    u[0][i] = number();
    u[1][i] = number();
    choice[i] = number();
    for (int k = 0; k < 3 && normals; ++k)
      normal[k][i] = number();
  }
}

faceta::light_module::LightQueries Queries::view() const {
  faceta::light_module::LightQueries q{};
  for (int k = 0; k < 3; ++k) {
    q.p[k] = p[k].data();
    q.normal[k] = normal[k].data();
  }
  q.u[0] = u[0].data();
  q.u[1] = u[1].data();
  q.choice = choice.data();
  q.light = light.data();
  return q;
}

Samples sample_lights(const SceneView& scene, const Queries& q) {
  size_t n = q.count;
  std::vector<float> first, floats(8 * n);
  Samples s;
  s.valid.resize(n);
  s.delta.resize(n);
  auto array = [&](int k) { return &floats[k * n]; };
  faceta::light_module::LightAnswers answers{{array(0), array(1), array(2)},
                                             {array(3), array(4), array(5)},
                                             array(6),
                                             array(7),
                                             s.valid.data(),
                                             s.delta.data()};
  for (const faceta::light_module::LightTable* table : light_tables()) {
    table->sample(scene, q.view(), answers, q.count);
    for (size_t i = 0; i < n; ++i) // where nothing is sampled nothing is promised
      for (int k = 0; k < 8 && !s.valid[i]; ++k)
        array(k)[i] = 0;
    if (first.empty())
      first = floats;
    EXPECT_EQ(std::memcmp(first.data(), floats.data(), 4 * floats.size()), 0)
        << "lanes: " << table->width;
  }
  for (size_t i = 0; i < n; ++i) {
    s.offset.push_back({first[i], first[n + i], first[2 * n + i]});
    s.direction.push_back({first[3 * n + i], first[4 * n + i], first[5 * n + i]});
    s.distance.push_back(first[6 * n + i]);
    s.pdf.push_back(first[7 * n + i]);
  }
  return s;
}

std::vector<double> light_pdfs(const SceneView& scene, const Queries& q,
                               const std::vector<Double3>& offsets) {
  std::vector<float> in[3], pdf(q.count), first;
  for (int k = 0; k < 3; ++k) {
    for (const Double3& o : offsets)
      in[k].push_back(static_cast<float>(o[k]));
    in[k].resize(q.count);
  }
  for (const faceta::light_module::LightTable* table : light_tables()) {
    table->pdf(scene, q.view(), {in[0].data(), in[1].data(), in[2].data()}, pdf.data(), q.count);
    if (first.empty())
      first = pdf;
    EXPECT_EQ(std::memcmp(first.data(), pdf.data(), 4 * pdf.size()), 0) << table->width;
  }
  return {first.begin(), first.end()};
}

LoneLight rectangle_light(const Double3& corner, const Double3& e1, const Double3& e2) {
  LoneLight l = new_light("rectangle");
  Double3 n = normalize(cross(e1, e2)), a = scale(e1, 0.5), b = scale(e2, 0.5);
  Mesh mesh = make_rectangle();
  place(mesh, columns(a, b, n, combine(corner, a, 1, b, 1)));
  l.scene->add_mesh(mesh, lamp(*l.scene), true);
  l.scene->build(best_isa());
  double area = length(cross(e1, e2));
  l.element = [=](double s, double t) {
    return SurfaceElement{combine(corner, e1, s, e2, t), n, area};
  };
  l.square = [=](const Double3& p) {
    Double3 d = sub(p, corner);
    return std::array{dot(d, e1) / dot(e1, e1), dot(d, e2) / dot(e2, e2)};
  };
  l.polygon = {corner, add(corner, e1), combine(corner, e1, 1, e2, 1), add(corner, e2)};
  return l;
}

LoneLight triangle_light(const Double3& a, const Double3& b, const Double3& c) {
  LoneLight l = new_light("triangle");
  Mesh mesh;
  for (const Double3& v : {a, b, c})
    for (double x : v)
      mesh.positions.push_back(static_cast<float>(x));
  mesh.indices = {0, 1, 2};
  l.scene->add_mesh(mesh, lamp(*l.scene));
  l.scene->build(best_isa());
  Double3 e1 = sub(b, a), e2 = sub(c, a), n = cross(e1, e2);
  double n2 = dot(n, n), area = std::sqrt(n2);
  Double3 unit = normalize(n);
  // (s, t) -> barycentrics (s (1 - t), s t): the area of the square's column s is s.
  l.element = [=](double s, double t) {
    return SurfaceElement{combine(a, e1, s * (1 - t), e2, s * t), unit, area * s};
  };
  l.square = [=](const Double3& p) {
    Double3 d = sub(p, a);
    double u = dot(cross(d, e2), n) / n2, v = dot(cross(e1, d), n) / n2;
    return std::array{u + v, u + v > 0 ? v / (u + v) : 0};
  };
  l.polygon = {a, b, c};
  return l;
}

LoneLight sphere_light(const Double3& center, double radius, bool inward) {
  LoneLight l = new_light("sphere");
  l.scene->add_sphere(make_sphere(center, radius, inward, kIdentityToWorld), lamp(*l.scene));
  l.scene->build(best_isa());
  l.element = [=](double s, double t) {
    double z = 1 - 2 * s, r = std::sqrt(1 - z * z), phi = 2 * kPi * t;
    Double3 n{r * std::cos(phi), r * std::sin(phi), z};
    return SurfaceElement{add(center, scale(n, radius)), scale(n, inward ? -1 : 1),
                          4 * kPi * radius * radius};
  };
  l.square = [=](const Double3& p) {
    Double3 d = normalize(sub(p, center));
    return std::array{0.5 * (1 - d[2]), turn(d[1], d[0])};
  };
  return l;
}

LoneLight disk_light(const Double3& center, const Double3& a, const Double3& b) {
  LoneLight l = new_light("disk");
  Double3 n = normalize(cross(a, b));
  l.scene->add_disk(make_disk(false, columns(a, b, n, center)), lamp(*l.scene));
  l.scene->build(best_isa());
  double area = kPi * length(cross(a, b));
  l.element = [=](double s, double t) {
    double r = std::sqrt(s), phi = 2 * kPi * t;
    return SurfaceElement{combine(center, a, r * std::cos(phi), b, r * std::sin(phi)), n, area};
  };
  l.square = [=](const Double3& p) {
    Double3 d = sub(p, center), normal = cross(a, b);
    double n2 = dot(normal, normal);
    double x = dot(cross(d, b), normal) / n2, y = dot(cross(a, d), normal) / n2;
    return std::array{x * x + y * y, turn(y, x)};
  };
  // A polygon of the same area.
  constexpr int kCorners = 4096;
  double stretch = std::sqrt(2 * kPi / kCorners / std::sin(2 * kPi / kCorners));
  for (int i = 0; i < kCorners; ++i) {
    double phi = 2 * kPi * i / kCorners;
    l.polygon.push_back(combine(center, a, stretch * std::cos(phi), b, stretch * std::sin(phi)));
  }
  return l;
}

LoneLight cylinder_light(const Double3& p0, const Double3& p1, double radius, bool inward) {
  LoneLight l = new_light("cylinder");
  l.scene->add_cylinder(make_cylinder(p0, p1, radius, inward, kIdentityToWorld), lamp(*l.scene));
  l.scene->build(best_isa());
  Double3 axis = sub(p1, p0), unit = normalize(axis);
  Basis basis = orthonormal_basis(unit);
  Double3 x = basis.s, y = basis.t;
  double height = length(axis);
  l.element = [=](double s, double t) {
    Double3 n = combine({}, x, std::cos(2 * kPi * s), y, std::sin(2 * kPi * s));
    return SurfaceElement{combine(p0, n, radius, axis, t), scale(n, inward ? -1 : 1),
                          2 * kPi * radius * height};
  };
  l.square = [=](const Double3& p) {
    Double3 d = sub(p, p0);
    return std::array{turn(dot(d, y), dot(d, x)), dot(d, unit) / height};
  };
  return l;
}

double polygon_irradiance(std::vector<Double3> polygon, const Double3& p, const Double3& n) {
  // The front is seen if the edge runs counter-clockwise.
  Double3 front{};
  for (size_t i = 0; i < polygon.size(); ++i)
    front = add(front, cross(sub(polygon[i], polygon[0]),
                             sub(polygon[(i + 1) % polygon.size()], polygon[0])));
  if (!(dot(sub(p, polygon[0]), front) > 0))
    return 0;
  for (Double3& v : polygon)
    v = sub(v, p);
  std::vector<Double3> above;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Double3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    double za = dot(a, n), zb = dot(b, n);
    if (za > 0)
      above.push_back(a);
    if ((za > 0) != (zb > 0))
      above.push_back(add(a, scale(sub(b, a), za / (za - zb))));
  }
  double sum = 0;
  for (size_t i = 0; i < above.size(); ++i) {
    const Double3 &a = above[i], &b = above[(i + 1) % above.size()];
    Double3 side = cross(a, b);
    sum += std::atan2(length(side), dot(a, b)) * dot(normalize(side), n);
  }
  // Seen from the front the edge turns clockwise about the way there.
  return -0.5 * sum;
}

double sphere_irradiance(double h, double theta) {
  double c = std::cos(theta), s = std::sin(theta), horizon = std::asin(1 / h);
  if (theta <= kPi / 2 - horizon)
    return kPi * c / (h * h);
  if (theta >= kPi / 2 + horizon)
    return 0;
  double q = std::sqrt(h * h - 1);
  return kPi / 2 - std::asin(q / (h * s)) +
         (c * std::acos(-q * c / s) - q * std::sqrt(1 - h * h * c * c)) / (h * h);
}

Double3 rounded(const Double3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

double chi_square_score(const std::vector<double>& expected, const std::vector<double>& observed) {
  double rest_expected = 0, rest_observed = 0, sum = 0;
  int cells = 0;
  auto add_cell = [&](double e, double o) {
    sum += (o - e) * (o - e) / e;
    ++cells;
  };
  for (size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] >= 5) {
      add_cell(expected[i], observed[i]);
    } else {
      rest_expected += expected[i];
      rest_observed += observed[i];
    }
  }
  if (rest_expected >= 5)
    add_cell(rest_expected, rest_observed);
  else if (rest_observed > 30)
    return 99;
  double k = std::max(1, cells - 1), v = 2 / (9 * k);
  return (std::cbrt(sum / k) - (1 - v)) / std::sqrt(v);
}

Estimate estimate(const std::vector<double>& values) {
  double sum = 0, squares = 0, n = double(values.size());
  for (double v : values)
    sum += v;
  for (double v : values)
    squares += (v - sum / n) * (v - sum / n);
  return {sum / n, std::sqrt(squares / (n - 1) / n)};
}

} // namespace test
