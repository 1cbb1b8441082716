#pragma once

/// A scene in memory: what readers build and the renderer views. Filled by the add
/// functions, frozen by build(): then only view() is used, by any number of threads.

#include "bsdf/registry.h"
#include "image/bitmap.h"
#include "image/image.h"
#include "scene/mesh.h"
#include "scene/primitives.h"
#include "scene/view.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace faceta {

/// A texture. Bitmaps are converted to 4 x 4-texel tiles; 8-bit ones stay 8-bit.
struct TextureDesc {
  TextureType type = TextureType::constant;
  std::shared_ptr<const Bitmap> bitmap;
  bool raw = false; ///< no sRGB decoding
  WrapMode wrap = WrapMode::repeat;
  bool nearest = false;
  std::array<double, 6> to_uv{1, 0, 0, 0, 1, 0}; ///< rows of a 2x3 map
  std::array<double, 3> color[2] = {{0.4, 0.4, 0.4}, {0.2, 0.2, 0.2}};
  int child[2] = {-1, -1};
};

/// A number or a texture, where the contract allows both. With a texture, `value` is ignored.
struct TexturedValue {
  std::array<double, 3> value{0, 0, 0};
  int texture = -1;
};

/// A node of a material tree.
struct MaterialNode {
  enum class Kind { model, blend, mask, twosided, null };
  Kind kind = Kind::model;
  // model
  std::shared_ptr<Parameters> parameters;
  std::vector<std::pair<std::string, int>> textures; ///< parameter name -> texture
  // blend: weight of the second child; mask: opacity
  TexturedValue weight;
  std::vector<std::shared_ptr<MaterialNode>> children;
  SourcePosition where;
};

/// Materials with their ids, which may be empty.
using NamedMaterials = std::vector<std::pair<std::string, std::shared_ptr<MaterialNode>>>;

/// Light leaving a shape.
struct AreaEmitter {
  TexturedValue radiance;
  double sampling_weight = 1; ///< multiplies the power in light choice; 0: found by chance only
};

struct ShapeDesc {
  int material = -1; ///< from add_material
  std::shared_ptr<AreaEmitter> emitter;
  std::string name; ///< id or file name, for messages
};

struct PointLightDesc {
  Double3 position{};
  std::array<double, 3> intensity{1, 1, 1};
  double sampling_weight = 1;
};

struct EnvironmentDesc {
  std::array<double, 3> radiance{1, 1, 1}; ///< constant radiance, or a factor on the image
  std::shared_ptr<const Image> image;      ///< latitude-longitude, linear, at least 2 x 3; or null
  ToWorld to_world = kIdentityToWorld;     ///< rotation or mirroring; a uniform scale has no effect
  double sampling_weight = 1;
};

struct CameraDesc {
  ToWorld to_world = kIdentityToWorld;
  double x_fov = 50; ///< degrees, across the width of the whole film
  double near_clip = 0.01, far_clip = 1e4;
  double principal_point[2] = {0, 0}; ///< offset relative to the film's size
};

enum class FilterType { box, tent, gaussian };
struct FilterDesc {
  FilterType type = FilterType::gaussian;
  double radius = 1;   ///< tent
  double stddev = 0.5; ///< gaussian; its radius is 4 stddev
};

/// File, size and channels of the picture as the scene wants them.
struct FilmDesc {
  int width = 768, height = 576;
  int crop_x = 0, crop_y = 0, crop_width = 0, crop_height = 0; ///< 0: the whole film
  std::string file_format = "openexr", pixel_format = "rgb", component_format = "float16";
  FilterDesc filter;
};

/// What a scene file says about how to render it.
struct IntegratorDesc {
  std::string type = "path"; ///< path or direct
  int max_depth = -1, rr_depth = 5;
  bool hide_emitters = false;
  int emitter_samples = 1, bsdf_samples = 1; ///< direct
  double timeout = -1;
  std::string moment_name; ///< set if a moment integrator wraps this one: its child's name
  bool moments = false;
};
struct SamplerDesc {
  std::string type = "sobol"; ///< independent or sobol
  int sample_count = 4;
  uint32_t seed = 0;
};

struct SensorDesc {
  CameraDesc camera;
  FilmDesc film;
  SamplerDesc sampler;
  std::string id;
};

struct SceneStatistics {
  size_t triangles = 0, quadrics = 0, lights = 0, textures = 0, materials = 0, bytes = 0;
};

class Scene {
public:
  Scene();
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  int add_texture(const TextureDesc& texture);
  /// The mean colour over the unit square (to_uv ignored): what lobe choices of plastics use.
  std::array<double, 3> texture_mean(int texture) const;
  /// A material tree; validated (depth, leaf count <= 64, nothing transmissive under twosided).
  int add_material(const std::shared_ptr<MaterialNode>& root);
  /// A mesh already placed in world space. An emitter turns each triangle into a light; the two
  /// triangles of a rectangle (`rectangle` true, orthogonal edges) become one rectangle light.
  void add_mesh(const Mesh& mesh, const ShapeDesc& shape, bool rectangle = false);
  void add_sphere(const Sphere& sphere, const ShapeDesc& shape);
  void add_disk(const Disk& disk, const ShapeDesc& shape);
  void add_cylinder(const Cylinder& cylinder, const ShapeDesc& shape);
  void add_point_light(const PointLightDesc& light);
  void set_environment(const EnvironmentDesc& environment); ///< twice is an Error

  std::vector<SensorDesc> sensors;
  IntegratorDesc integrator;
  /// Named materials, for `faceta eval --scene --id`.
  NamedMaterials named_materials;

  /// Builds Embree's tree (pinned to AVX2), programs, classes, the light BVH and the environment's
  /// tables for the kernels of an instruction set. Called again, only the kernels are exchanged.
  /// Error if this CPU has no kernels of that set or Embree runs out of memory.
  void build(Isa isa);
  /// Chooses a sensor and film region for view(); `film` may differ from the sensor's own. Error
  /// for what makes no camera: a scale in to_world, an angle outside (0, 180), a crop off the film.
  void use_sensor(const CameraDesc& camera, const FilmDesc& film);
  const SceneView& view() const;
  /// The root of view().roots that a material of add_material() became. After build().
  int view_root(int material) const;
  SceneStatistics statistics() const;

  struct Impl;

private:
  std::unique_ptr<Impl> impl_;
};

} // namespace faceta
