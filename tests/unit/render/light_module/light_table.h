#pragma once

/// The sampling of lights as the renderer's kernels do it, as loops over arrays: compiled once per
/// instruction set into a small module of the tests.

#include "scene/view.h"

namespace faceta::light_module {

/// Points with normals, random numbers, and a light each; all arrays are n long.
struct LightQueries {
  const float *p[3], *normal[3], *u[2], *choice;
  const int32_t* light;
};

/// A sampled point of a light, and the density that MIS gives to finding it by chance.
struct LightAnswers {
  float *offset[3], *direction[3], *distance, *pdf;
  int32_t *valid, *delta;
};

struct EnvironmentAnswers {
  float *direction[3], *radiance[3], *pdf;
};

struct LightTable {
  int width;
  /// sample_light(). n is a multiple of 16, here and below.
  void (*sample)(const SceneView& scene, const LightQueries& q, const LightAnswers& a, int n);
  /// light_direction_pdf() for points at `offset` from q.p where the surface has normal q.normal.
  void (*pdf)(const SceneView& scene, const LightQueries& q, const float* const (&offset)[3],
              float* pdf, int n);
  /// choose_light() with the numbers q.choice.
  void (*choose)(const SceneView& scene, const LightQueries& q, int32_t* light, float* probability,
                 int n);
  /// light_probability() of q.light.
  void (*probability)(const SceneView& scene, const LightQueries& q, float* probability, int n);
  /// A direction to the environment from q.u, and for images the choice q.normal[0], q.normal[1].
  void (*sample_environment)(const EnvironmentView& e, const LightQueries& q,
                             const EnvironmentAnswers& a, int n);
  /// What arrives from a.direction.
  void (*environment)(const EnvironmentView& e, const EnvironmentAnswers& a, int n);
};

} // namespace faceta::light_module
