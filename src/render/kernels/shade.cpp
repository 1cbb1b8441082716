#include "render/kernels/wavefront.h"

namespace faceta {

namespace {
constexpr int kPoolRows = kPoolSize + Wavefront::kPad;
constexpr int kShadowStride = kPoolRows;
// Pairs of random numbers: the film takes pair 0, each vertex five.
constexpr int kPairsPerVertex = 5;

Wavefront::I first_pair(const Wavefront::I& depth) {
  return Wavefront::I(1) + depth * Wavefront::I(kPairsPerVertex);
}
} // namespace

void Wavefront::shade_class(const ClassView& c, int first, int n) {
  // While a group is shaded, the memory that the next one needs is on its way.
  Group groups[2];
  begin_group(c, first, n, groups[0]);
  for (int i = 0; i < n; i += W) {
    int k = (i / W) & 1;
    if (i + W < n)
      begin_group(c, first + i + W, n - i - W, groups[k ^ 1]);
    shade_group(c, groups[k]);
  }
  counters_.vertices += n;
  counters_.groups += (n + W - 1) / W;
}

void Wavefront::surface_points(const I& index, const I& code, bool need_uv, Group& g) const {
  const PathLanes& path = g.path;
  M is_quadric = code >= I(kQuadricHit);
  if (none(is_quadric)) {
    g.surface = triangle_point<T>(scene_, code, path.o, path.d, need_uv);
    return;
  }
  I quadric_index = select(is_quadric, code - I(kQuadricHit), I(0));
  SurfaceLanes<T> q =
      quadric_point<T>(scene_, quadric_index, path.o, path.d, gather<T>(distances_, index));
  if (all(is_quadric)) {
    g.surface = q;
    return;
  }
  SurfaceLanes<T> t =
      triangle_point<T>(scene_, select(is_quadric, I(0), code), path.o, path.d, need_uv);
  SurfaceLanes<T>& s = g.surface;
  s.p = select(is_quadric, q.p, t.p);
  s.geometric = select(is_quadric, q.geometric, t.geometric);
  s.frame = {select(is_quadric, q.frame.s, t.frame.s), select(is_quadric, q.frame.t, t.frame.t),
             select(is_quadric, q.frame.n, t.frame.n)};
  s.uv = {select(is_quadric, q.uv.x, t.uv.x), select(is_quadric, q.uv.y, t.uv.y)};
  s.material = select(is_quadric, q.material, t.material);
  s.light = select(is_quadric, q.light, t.light);
}

/// Light that the path met by chance, weighted against having sampled it.
Color<Lanes> Wavefront::emission(const PathLanes& path, const SurfaceLanes<T>& s, M active) {
  M lit = active & (s.light >= I(0)) & (dot(path.d, s.frame.n) < T(0));
  if (job_.settings.hide_emitters)
    lit = lit & (path.depth > I(0));
  if (none(lit))
    return Color<T>(T(0));
  Color<T> light;
  with_lights<T>(scene_, select(lit, s.light, I(0)),
                 [&](const LightLanes<T>& l) FACETA_INLINE_LAMBDA {
                   light = l.radiance;
                   M textured = lit & (l.texture >= I(0));
                   if (any(textured))
                     light *= evaluate_textures<T>(scene_.textures, l.texture, s.uv, textured);
                   M weighed = lit & (path.pdf > T(0)) & (l.depth >= I(0));
                   if (none(weighed))
                     return;
                   Vec3<T> n = unpack_normal<T>(path.normal);
                   T probability = light_probability(scene_, l, path.o, n, weighed);
                   T pdf = light_direction_pdf(l, path.o, s.p - path.o, s.geometric);
                   T share = T((1 - scene_.environment.probability) * job_.settings.light_fraction);
                   T w = power_heuristic(max(path.pdf, T(1e-30f)) * T(job_.settings.bsdf_fraction),
                                         pdf * probability * share);
                   light *= select(weighed, w, T(1));
                 });
  return select(lit, path.throughput * light, Color<T>(T(0)));
}

SampleStream<Lanes> Wavefront::stream_of(const PathLanes& path) const {
  const RenderSettings& settings = job_.settings;
  return SampleStream<T>(as_uint(path.pixel), as_uint(path.sample), settings.seed,
                         settings.sampler == SamplerType::sobol);
}

/// Where the vertices at these dimensions sample the environment: first the part of it ...
Vec2<Lanes> Wavefront::environment_choice(const SampleStream<T>& stream, const I& dimension) const {
  return stream.pair(as_uint(dimension + I(4)));
}
/// ... then the place in there.
Vec2<Lanes> Wavefront::environment_place(const SampleStream<T>& stream, const I& dimension,
                                         const Vec2<T>& choice) const {
  return choose_environment_place(scene_.environment, choice, stream.pair(as_uint(dimension)));
}

FACETA_INLINE Wavefront::LightSample Wavefront::sample_lights(const SurfaceLanes<T>& s,
                                                              const SampleStream<T>& stream,
                                                              const I& dimension, const T& choice,
                                                              const Vec2<T>& place) {
  const EnvironmentView& e = scene_.environment;
  Vec2<T> u{T(0), T(0)};
  if (e.probability < 1 || e.columns == 0) // else the place on the environment is known already
    u = stream.pair(as_uint(dimension));
  T p_environment = T(e.probability);
  M from_environment = choice < p_environment;
  LightSample r;
  r.delta = M(false);
  r.valid = M(false);
  r.radiance = Color<T>(T(0));
  r.pdf = T(1);
  r.distance = T(1);
  r.direction = s.frame.n;
  if (e.probability < 1) {
    T v = min((choice - p_environment) / (T(1) - p_environment), T(kOneMinusEpsilon));
    LightChoice<T> light = choose_light(scene_, s.p, s.frame.n, max(v, T(0)));
    T probability = light.probability * (T(1) - p_environment);
    with_lights<T>(scene_, light.light, [&](const LightLanes<T>& l) FACETA_INLINE_LAMBDA {
      LightPoint<T> point = sample_light(scene_, l, s.p, u);
      r.distance = point.distance;
      r.direction = point.direction;
      r.pdf = point.pdf * probability;
      r.delta = point.delta;
      r.valid = point.valid & (probability > T(0)) & !from_environment;
      r.radiance = l.radiance;
      M textured = r.valid & (l.texture >= I(0));
      if (any(textured))
        r.radiance *= evaluate_textures<T>(scene_.textures, l.texture, point.uv, textured);
      T density = select(r.valid, r.pdf, T(1));
      if (any(point.delta))
        density = select(point.delta, density * point.distance * point.distance, density);
      r.radiance *= T(1) / density;
    });
  }
  if (e.probability > 0 && any(from_environment)) {
    EnvironmentLight<T> light =
        e.columns ? sample_environment_place(e, place) : sample_constant_environment(e, u);
    T pdf = light.pdf * p_environment;
    r.direction = select(from_environment, light.direction, r.direction);
    r.distance = select(from_environment, T(1e30f), r.distance);
    r.pdf = select(from_environment, pdf, r.pdf);
    r.valid = select(from_environment, pdf > T(0), r.valid);
    r.delta = r.delta & !from_environment;
    Color<T> radiance = light.radiance * (T(1) / select(pdf > T(0), pdf, T(1)));
    r.radiance = select(from_environment, radiance, r.radiance);
  }
  return r;
}

/// The first of the n paths from `first` in the order, at most W.
void Wavefront::begin_group(const ClassView& c, int first, int n, Group& g) const {
  g.active = first_lanes<T>(n);
  // Idle lanes repeat the first path.
  I index = select(g.active, load_int<T>(order_ + first), I(order_[first]));
  I code = select(g.active, load_int<T>(codes_ + first), I(codes_[first]));
  alignas(64) int32_t group[W];
  store(group, index);
  load_paths(group, g.path);
  bool untextured = c.single && (c.leaf.program < 0 || !scene_.programs[c.leaf.program].textured);
  surface_points(index, code, !untextured, g);
  shader_.prefetch(c, g.surface.material, g.surface.uv, g.active);
  g.place = g.next_choice = {T(0), T(0)};
  const EnvironmentView& e = scene_.environment;
  if (e.columns) {
    Neighbours<T> place = gather_pair<T>(places_, index << 1);
    g.place = {place.first, place.second};
    g.next_choice = environment_choice(stream_of(g.path), first_pair(g.path.depth + I(1)));
    prefetch_cells(environment_spot(e, g.place.x, g.place.y, T(0)).cell);
  }
}

/// Adds the light of what the paths of a group met. Returns those that go on.
FACETA_INLINE Wavefront::M Wavefront::meet(const Group& g) {
  const RenderSettings& settings = job_.settings;
  const PathLanes& path = g.path;
  const SurfaceLanes<T>& s = g.surface;
  M active = g.active;
  if (settings.hide_emitters) {
    M hidden = active & (path.depth == I(0)) & (s.light >= I(0));
    if (any(hidden))
      see_through(path, s, hidden);
    active = active & !hidden;
  }
  add(emission(path, s, active), path.slot, active & (s.light >= I(0)));
  if (settings.max_depth >= 0) {
    M ends = active & (path.depth + I(1) >= I(settings.max_depth));
    M lit = (s.light >= I(0)) & (dot(path.d, s.frame.n) < T(0));
    if (!settings.alpha_of_hits && !environment_is_seen())
      clear_alpha(path.slot, ends & !lit & (path.pdf == T(kUnscattered)));
    active = active & !ends;
  }
  return active;
}

void Wavefront::shade_group(const ClassView& c, Group& g) {
  const RenderSettings& settings = job_.settings;
  const PathLanes& path = g.path;
  const SurfaceLanes<T>& s = g.surface;
  M active = meet(g);
  if (none(active))
    return;

  SampleStream<T> stream = stream_of(path);
  I dimension = first_pair(path.depth);
  ShadingQuery<T> q;
  q.wo = s.frame.to_local(-path.d);
  q.uv = s.uv;
  q.u = stream.pair(as_uint(dimension + I(1)));
  Vec2<T> choices = stream.pair(as_uint(dimension + I(2))); // of a light, of a lobe
  q.uc = choices.y;
  q.root = s.material;
  q.active = active;
  q.wi_light = q.wo;

  // Sub-paths of the direct integrator: the first light_splits sample lights, the first bsdf_splits
  // follow the material.
  M use_light = active, use_bsdf = active;
  if (settings.splits > 1 || settings.light_splits == 0 || settings.bsdf_splits == 0) {
    T whole = floor((to_float(path.sample) + T(0.5f)) * T(1.0f / settings.splits));
    I split = path.sample - to_int(whole) * I(settings.splits);
    use_light = active & (split < I(settings.light_splits));
    use_bsdf = active & (split < I(settings.bsdf_splits));
  }
  bool delta_only = c.single && c.leaf.program >= 0 && scene_.programs[c.leaf.program].delta_only;
  bool lights = (scene_.environment.probability > 0 || scene_.light_nodes[0].child >= 0 ||
                 scene_.light_nodes[0].light >= 0) &&
                !delta_only && any(use_light);
  LightSample l;
  if (lights) {
    l = sample_lights(s, stream, dimension, choices.x, g.place);
    q.wi_light = s.frame.to_local(l.direction);
  }
  ShadingResult<T> r = shader_.shade(c, q);
  if (lights) {
    T pdf = r.light.pdf * T(settings.bsdf_fraction);
    T weight = select(l.delta | (settings.bsdf_splits == 0 ? M(true) : M(false)), T(1),
                      power_heuristic(l.pdf * T(settings.light_fraction), pdf));
    weight = weight * T(settings.light_scale);
    Color<T> contribution = path.throughput * r.light.value * l.radiance * weight;
    M useful = use_light & l.valid & (max_component(contribution) > T(0));
    queue_shadow(s, l, contribution, path.slot, useful);
  }
  continue_paths(path, s, r.sample, stream, dimension, g.next_choice, use_bsdf);
}

/// The camera does not see emitters that are hidden: its rays go on behind them, unchanged.
void Wavefront::see_through(const PathLanes& path, const SurfaceLanes<T>& s, M mask) {
  Vec3<T> o = offset_origin(s, path.d, T(scene_scale_));
  store_paths(path, o, path.d, path.pdf, path.eta, path.throughput, path.depth, I(0), mask);
  if (scene_.environment.columns) {
    SampleStream<T> stream = stream_of(path);
    I dimension = first_pair(I(0));
    Vec2<T> place = environment_place(stream, dimension, environment_choice(stream, dimension));
    store_places(place, next_count_ - count(mask), mask);
  }
}

/// Appends paths to the pool of the next round and counts them as alive.
void Wavefront::store_paths(const PathLanes& path, const Vec3<T>& o, const Vec3<T>& d, const T& pdf,
                            const T& eta, const Color<T>& throughput, const I& depth,
                            const I& normal, M mask) {
  T row[16] = {o.x,
               o.y,
               o.z,
               d.x,
               d.y,
               d.z,
               pdf,
               eta,
               throughput[0],
               throughput[1],
               throughput[2],
               bits_float(path.slot),
               bits_float(path.pixel),
               bits_float(path.sample),
               bits_float(depth),
               bits_float(normal)};
  next_count_ += store_rows<T>(next_rows_ + 16 * next_count_, mask, row);
  // Chunks stay open while one of their paths lives; in flight are at most kChunkRing of them.
  I ring = path.slot >> kChunkShift;
  for (uint64_t i = head_; i < tail_; ++i) {
    int index = static_cast<int>(i % kChunkRing);
    ring_[index].alive += count(mask & (ring == I(index)));
  }
}

void Wavefront::store_places(const Vec2<T>& place, int first, M mask) {
  compress_store_pairs(next_places_ + 2 * first, place.x, place.y, mask);
}

void Wavefront::queue_shadow(const SurfaceLanes<T>& s, const LightSample& l,
                             const Color<T>& contribution, const I& slot, M mask) {
  if (none(mask))
    return;
  Vec3<T> o = offset_origin(s, l.direction, T(scene_scale_));
  const T fields[10] = {o.x,
                        o.y,
                        o.z,
                        l.direction.x,
                        l.direction.y,
                        l.direction.z,
                        l.distance * T(1 - 1e-4f),
                        contribution[0],
                        contribution[1],
                        contribution[2]};
  float* out = shadow_rays_ + shadow_count_;
  for (int k = 0; k < 10; ++k)
    compress_store(out + k * kShadowStride, fields[k], mask);
  compress_store(shadow_slots_ + shadow_count_, slot, mask);
  shadow_count_ += count(mask);
}

void Wavefront::continue_paths(const PathLanes& path, const SurfaceLanes<T>& s,
                               const Sample<T>& sample, const SampleStream<T>& stream,
                               const I& dimension, const Vec2<T>& next_choice, M active) {
  Vec3<T> d = s.frame.to_world(sample.wi);
  // Of length 1 but for rounding: one Newton step keeps long chains of mirrors from drifting.
  d = d * fma(T(-0.5f), dot(d, d), T(1.5f));
  Color<T> throughput = path.throughput * sample.weight * T(job_.settings.bsdf_scale);
  T eta = path.eta * sample.eta;
  T largest = max_component(throughput);
  M alive = active & sample.valid & (largest > T(0));
  I depth = path.depth + I(1);
  M roulette = depth >= I(job_.settings.rr_depth);
  if (any(alive & roulette)) {
    T q = min(largest * eta * eta, T(0.95f));
    T u = stream.pair(as_uint(dimension + I(3))).x;
    throughput = select(roulette, throughput * (T(1) / q), throughput);
    alive = alive & ((!roulette) | (u < q));
  }
  T pdf = select(sample.delta, T(-1), sample.pdf);
  M through = sample.valid & (sample.lobe == I(kNullLobe)) & (path.pdf == T(kUnscattered));
  if (any(through)) {
    pdf = select(through, T(kUnscattered), pdf);
    if (!job_.settings.alpha_of_hits && !environment_is_seen())
      clear_alpha(path.slot, active & through & !alive);
  }
  if (none(alive))
    return;
  Vec3<T> o = offset_origin(s, d, T(scene_scale_));
  if (scene_.environment.columns)
    store_places(environment_place(stream, first_pair(depth), next_choice), next_count_, alive);
  I normal = scene_.light_nodes[0].child >= 0 ? pack_normal(s.frame.n) : I(0);
  store_paths(path, o, d, pdf, eta, throughput, depth, normal, alive);
}

void Wavefront::shadows() {
  if (shadow_count_ == 0)
    return;
  const float* a = shadow_rays_;
  constexpr int n = kShadowStride;
  RayArrays rays{{a, a + n, a + 2 * n}, {a + 3 * n, a + 4 * n, a + 5 * n}, nullptr, a + 6 * n};
  if (job_.record) {
    std::vector<float> near(shadow_count_, 0.0f);
    RayArrays recorded = rays;
    recorded.near = near.data();
    job_.record(job_.user, RayKind::shadow, &recorded, shadow_count_);
  }
  trace_shadow(scene_, rays, shadow_count_, shadow_far_);
  const float* const contributions[3] = {a + 7 * n, a + 8 * n, a + 9 * n};
  add_unblocked(contributions, shadow_far_, shadow_slots_, shadow_count_, radiance_);
  counters_.shadow_rays += shadow_count_;
}

} // namespace faceta
