#include "scene/lights.h"

#include <algorithm>
#include <cmath>

namespace faceta {

using namespace double3;

namespace {

Double3 load(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

void put(float (&to)[3], const Double3& from) {
  for (int k = 0; k < 3; ++k)
    to[k] = static_cast<float>(from[k]);
}

/// uv = (b1, b2), as the kernels sample disks and cylinders.
void identity_uv(LightRecord& r) {
  r.duv1[0] = r.duv2[1] = 1;
}

LightBounds flat_bounds(const Box& box, const Double3& normal) {
  return {.low = box.low, .high = box.high, .axis = normal, .cos_spread = 1};
}

LightBounds round_bounds(const Box& box) {
  return {.low = box.low, .high = box.high};
}

} // namespace

int LightStore::add(LightRecord record, LightBounds bounds, const Emission& emission,
                    double flux_factor) {
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(emission.radiance[c]))
      throw Error("the radiance of a light is not finite");
    record.radiance[c] = static_cast<float>(emission.radiance[c]);
  }
  if (!(emission.sampling_weight >= 0) || !std::isfinite(emission.sampling_weight))
    throw Error("sampling_weight of a light must be a finite number, 0 or more");
  record.texture = emission.texture;
  double power = std::max(0.0, emission.brightness) * flux_factor;
  bounds.power = power * emission.sampling_weight;
  // The kernels' single precision must see it, too.
  if (!(static_cast<float>(bounds.power) > 1e-30f) || !std::isfinite(bounds.power))
    bounds.power = 0;
  if (bounds.power > 0) {
    power_ += power;
    weighted_power_ += bounds.power;
  }
  records_.push_back(record);
  bounds_.push_back(bounds);
  return count() - 1;
}

int LightStore::add_flat(LightType type, const TriangleRecord& t, int primitive,
                         const Emission& emission) {
  bool rectangle = type == LightType::rectangle;
  Double3 v0 = load(t.v0), e1 = load(t.e1), e2 = load(t.e2);
  Double3 n = cross(e1, e2);
  double area = length(n) * (rectangle ? 1 : 0.5);
  n = normalize(n);
  // Light leaves on the side of the shading normals, which may differ from the winding's.
  if (dot(n, double3::add(load(t.n0), double3::add(load(t.n1), load(t.n2)))) < 0)
    n = scale(n, -1);
  LightRecord r{};
  r.type = static_cast<int32_t>(type);
  r.primitive = primitive;
  r.area = static_cast<float>(area);
  put(r.p, v0);
  put(r.e1, e1);
  put(r.e2, e2);
  put(r.n, n);
  r.length1 = static_cast<float>(length(e1));
  r.length2 = static_cast<float>(length(e2));
  r.inverse1 = static_cast<float>(1 / length(e1));
  r.inverse2 = static_cast<float>(1 / length(e2));
  for (int c = 0; c < 2; ++c) {
    r.uv0[c] = t.uv0[c];
    r.duv1[c] = t.uv1[c] - t.uv0[c];
    r.duv2[c] = t.uv2[c] - t.uv0[c];
  }
  Box box{v0, v0};
  for (const Double3& offset : {e1, e2, rectangle ? double3::add(e1, e2) : e1})
    for (int k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], v0[k] + offset[k]);
      box.high[k] = std::max(box.high[k], v0[k] + offset[k]);
    }
  return add(r, flat_bounds(box, n), emission, kPi * area);
}

int LightStore::add_triangle(const TriangleRecord& triangle, int primitive,
                             const Emission& emission) {
  return add_flat(LightType::triangle, triangle, primitive, emission);
}

int LightStore::add_rectangle(const TriangleRecord& triangle, int primitive,
                              const Emission& emission) {
  return add_flat(LightType::rectangle, triangle, primitive, emission);
}

int LightStore::add_sphere(const Sphere& sphere, int primitive, const Emission& emission) {
  LightRecord r{};
  r.type = static_cast<int32_t>(LightType::sphere);
  r.primitive = primitive;
  r.area = static_cast<float>(surface_area(sphere));
  r.radius = static_cast<float>(sphere.radius);
  put(r.p, sphere.center);
  r.n[0] = sphere.flip ? -1.0f : 1.0f;
  Double3 reach{sphere.radius, sphere.radius, sphere.radius};
  Box box{sub(sphere.center, reach), double3::add(sphere.center, reach)};
  identity_uv(r);
  return add(r, round_bounds(box), emission, kPi * surface_area(sphere));
}

int LightStore::add_disk(const Disk& disk, const Box& box, int primitive,
                         const Emission& emission) {
  LightRecord r{};
  r.type = static_cast<int32_t>(LightType::disk);
  r.primitive = primitive;
  r.area = static_cast<float>(surface_area(disk));
  put(r.p, disk.center);
  put(r.n, disk.normal);
  identity_uv(r);
  return add(r, flat_bounds(box, disk.normal), emission, kPi * surface_area(disk));
}

int LightStore::add_cylinder(const Cylinder& cylinder, const Box& box, int primitive,
                             const Emission& emission) {
  LightRecord r{};
  r.type = static_cast<int32_t>(LightType::cylinder);
  r.primitive = primitive;
  r.area = static_cast<float>(surface_area(cylinder));
  put(r.p, cylinder.p0);
  identity_uv(r);
  // Elliptic and slanted tubes are not sampled uniformly by (phi, z): light from them is left to
  // chance, which is noisier but right.
  double factor = cylinder.warning.empty() ? kPi * surface_area(cylinder) : 0;
  return add(r, round_bounds(box), emission, factor);
}

int LightStore::add_point(const Double3& position, const Emission& intensity) {
  if (!finite(position))
    throw Error("the position of a point light is not finite");
  LightRecord r{};
  r.type = static_cast<int32_t>(LightType::point);
  r.primitive = -1;
  put(r.p, position);
  return add(r, round_bounds({position, position}), intensity, 4 * kPi);
}

void LightStore::build() {
  std::vector<int> first;
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < count(); ++i)
      if ((bounds_[i].power > 0) == (pass == 0))
        first.push_back(i);
    if (pass == 0)
      chosen_ = static_cast<int>(first.size());
  }
  order_.resize(records_.size());
  std::vector<LightRecord> records(records_.size());
  std::vector<LightBounds> bounds(chosen_);
  for (int k = 0; k < count(); ++k) {
    order_[first[k]] = k;
    records[k] = records_[first[k]];
    if (k < chosen_)
      bounds[k] = bounds_[first[k]];
  }
  tree_ = build_light_tree(bounds);
  for (int k = 0; k < count(); ++k) {
    records[k].trail = k < chosen_ ? tree_.trails[k].bits : 0;
    records[k].depth = k < chosen_ ? tree_.trails[k].depth : -1;
  }
  records_ = std::move(records);
  bounds_.clear();
  bounds_.shrink_to_fit();
}

double LightStore::mean_weight() const {
  return power_ > 0 ? weighted_power_ / power_ : 0;
}

size_t LightStore::bytes() const {
  return records_.size() * sizeof(LightRecord) + tree_.nodes.size() * sizeof(LightNode);
}

} // namespace faceta
