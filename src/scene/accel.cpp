#include "scene/accel.h"

#include "base/error.h"
#include "base/huge_pages.h"

#include <cmath>
#include <embree3/rtcore.h>
#include <limits>
#include <tbb/parallel_for.h>

namespace faceta {

namespace {

constexpr unsigned kTriangles = 0, kQuadrics = 1;
// Embree reads 16 bytes from the last vertex on.
constexpr size_t kPadding = 4;

float below(double x) {
  float f = static_cast<float>(x);
  return f > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

void quadric_bounds(const RTCBoundsFunctionArguments* args) {
  const auto* geometry = static_cast<const SceneGeometry*>(args->geometryUserPtr);
  const Box& box = geometry->quadric_shapes[args->primID].box;
  RTCBounds& b = *args->bounds_o;
  b.lower_x = below(box.low[0]), b.upper_x = -below(-box.high[0]);
  b.lower_y = below(box.low[1]), b.upper_y = -below(-box.high[1]);
  b.lower_z = below(box.low[2]), b.upper_z = -below(-box.high[2]);
}

/// Distance along ray i of a packet, negative for a miss.
double quadric_distance(void* user, unsigned primitive, RTCRayN* ray, unsigned n, unsigned i) {
  const auto* geometry = static_cast<const SceneGeometry*>(user);
  Double3 o{RTCRayN_org_x(ray, n, i), RTCRayN_org_y(ray, n, i), RTCRayN_org_z(ray, n, i)};
  Double3 d{RTCRayN_dir_x(ray, n, i), RTCRayN_dir_y(ray, n, i), RTCRayN_dir_z(ray, n, i)};
  return intersect(geometry->quadric_shapes[primitive], o, d, RTCRayN_tnear(ray, n, i),
                   RTCRayN_tfar(ray, n, i));
}

void intersect_quadric(const RTCIntersectFunctionNArguments* args) {
  unsigned n = args->N;
  RTCRayN* ray = RTCRayHitN_RayN(args->rayhit, n);
  RTCHitN* hit = RTCRayHitN_HitN(args->rayhit, n);
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] != -1)
      continue;
    double t = quadric_distance(args->geometryUserPtr, args->primID, ray, n, i);
    if (t < 0)
      continue;
    RTCRayN_tfar(ray, n, i) = static_cast<float>(t);
    RTCHitN_u(hit, n, i) = RTCHitN_v(hit, n, i) = 0;
    RTCHitN_Ng_x(hit, n, i) = RTCHitN_Ng_y(hit, n, i) = RTCHitN_Ng_z(hit, n, i) = 0;
    RTCHitN_primID(hit, n, i) = args->primID;
    RTCHitN_geomID(hit, n, i) = args->geomID;
    RTCHitN_instID(hit, n, i, 0) = args->context->instID[0];
  }
}

void occlude_quadric(const RTCOccludedFunctionNArguments* args) {
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] == -1 &&
        quadric_distance(args->geometryUserPtr, args->primID, args->ray, args->N, i) >= 0)
      RTCRayN_tfar(args->ray, args->N, i) = -std::numeric_limits<float>::infinity();
}

bool count_memory(void* counter, ssize_t bytes, bool) {
  *static_cast<std::atomic<int64_t>*>(counter) += bytes;
  return true;
}

/// All tasks that a thread starts have the floating-point mode it had when it first used TBB. With
/// Embree that would be one that flushes denormals, whatever the tasks are for.
void start_tbb() {
  tbb::parallel_for(0, 2, [](int) {});
}

} // namespace

Accelerator::~Accelerator() {
  if (scene_)
    rtcReleaseScene(scene_);
  if (device_)
    rtcReleaseDevice(device_);
}

void Accelerator::check(const char* what) const {
  RTCError code = rtcGetDeviceError(device_);
  if (code == RTC_ERROR_NONE)
    return;
  throw Error(std::string("Embree could not ") + what, {},
              code == RTC_ERROR_OUT_OF_MEMORY ? "out of memory"
                                              : "error " + std::to_string(int(code)));
}

void Accelerator::build(SceneGeometry& geometry) {
  start_tbb();
  // One instruction set on all machines that have it: Embree's sets differ in the last bits.
  device_ = rtcNewDevice(__builtin_cpu_supports("avx2") ? "isa=avx2" : "");
  check("start");
  rtcSetDeviceMemoryMonitorFunction(device_, count_memory, &bytes_);
  scene_ = rtcNewScene(device_);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  if (!geometry.triangles.empty())
    attach_triangles(geometry);
  if (!geometry.quadrics.empty())
    attach_quadrics(geometry);
  rtcCommitScene(scene_);
  check("build the scene's tree");
  // Small trees fit into the caches and their page tables too.
  if (bytes() > (size_t(1) << 20))
    prefer_huge_pages();
}

void Accelerator::attach_triangles(SceneGeometry& geometry) {
  size_t vertices = geometry.positions.size() / 3;
  geometry.positions.resize(3 * vertices + kPadding);
  RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             geometry.positions.data(), 0, 12, vertices);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, geometry.indices.data(),
                             0, 12, geometry.triangles.size());
  rtcSetGeometryBuildQuality(g, RTC_BUILD_QUALITY_HIGH);
  rtcCommitGeometry(g);
  rtcAttachGeometryByID(scene_, g, kTriangles);
  rtcReleaseGeometry(g);
  check("take the triangles");
}

void Accelerator::attach_quadrics(SceneGeometry& geometry) {
  RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(geometry.quadrics.size()));
  rtcSetGeometryUserData(g, &geometry);
  rtcSetGeometryBoundsFunction(g, quadric_bounds, nullptr);
  rtcSetGeometryIntersectFunction(g, intersect_quadric);
  rtcSetGeometryOccludedFunction(g, occlude_quadric);
  rtcCommitGeometry(g);
  rtcAttachGeometryByID(scene_, g, kQuadrics);
  rtcReleaseGeometry(g);
  check("take the quadrics");
}

} // namespace faceta
