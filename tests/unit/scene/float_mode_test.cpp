// Building a scene leaves the floating-point mode of tasks as it is: Embree flushes denormals.

#include "test_models.h"

#include <atomic>
#include <gtest/gtest.h>
#include <limits>
#include <tbb/parallel_for.h>
#include <thread>

namespace {

using namespace faceta;

// In a thread of its own, which has not used TBB yet.
TEST(FloatMode, TasksKeepDenormalsAfterAScene) {
  std::atomic<int> tasks{0}, kept{0};
  std::thread([&] {
    Scene scene;
    Mesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    mesh.indices = {0, 1, 2};
    scene.add_mesh(mesh, test::grey_shape(scene));
    scene.build(Isa::scalar);
    tbb::parallel_for(0, 64, [&](int) {
      volatile double tiny = std::numeric_limits<double>::denorm_min();
      ++tasks;
      kept += tiny > 0;
    });
  }).join();
  EXPECT_EQ(tasks, 64);
  EXPECT_EQ(kept, 64);
}

} // namespace
