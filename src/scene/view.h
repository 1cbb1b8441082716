#pragma once

/// A loaded scene as the render kernels see it: plain arrays and structs, shared by every
/// instruction set. Scene (scene.h) owns the memory. Records that lanes fetch are 64-byte rows, so
/// that sixteen of them are loaded and transposed instead of gathered field by field.

#include "bsdf/kernel.h"

#include <cstdint>

struct RTCSceneTy;

namespace faceta {

/// Set in TriangleRecord::shape where the shading normal is not that of the face.
inline constexpr int32_t kSmoothTriangle = 0x40000000;

/// One triangle in world space: two rows of 16 words.
struct alignas(64) TriangleRecord {
  float v0[3], e1[3], e2[3]; ///< first vertex and the edges to the others; normal = e1 x e2
  float dpdu[3];             ///< tangent along u, not normalised (0: none; any tangent will do)
  int32_t material;          ///< root material
  int32_t light;             ///< light record, -1 if it does not emit
  int32_t shape;             ///< index of the shape in the scene file | kSmoothTriangle
  float inverse_cross;       ///< 1 / |e1 x e2|, 0 if that is 0
  float n0[3], n1[3], n2[3]; ///< vertex normals (the face normal thrice where there are none)
  float uv0[2], uv1[2], uv2[2];
  float reserved2;
};
static_assert(sizeof(TriangleRecord) == 128);

enum class QuadricType : int32_t { sphere, disk, cylinder };

/// An analytic shape: two rows. Local coordinates: sphere radius 1 about the origin; disk radius 1
/// in z = 0; cylinder radius 1 about z in [0, 1].
struct alignas(64) QuadricRecord {
  float to_world[12]; ///< rows of a 3x4 affine map
  int32_t material, light, shape;
  int32_t type; ///< QuadricType
  float to_local[12];
  float flip; ///< -1: normals point inwards (spheres, cylinders) or downwards (disks), else 1
  float area;
  float reserved[2];
};
static_assert(sizeof(QuadricRecord) == 128);

enum class TextureType : int32_t { constant, bitmap8, bitmap_float, checkerboard };
enum class WrapMode : int32_t { repeat, mirror, clamp };

/// Texels lie in tiles of 4 x 4, which start at every third texel: their last row and column are
/// the first of the next tile, or what follows the bitmap's last texel. The 2 x 2 texels between
/// which a point lies are therefore always in one tile, of bytes one line of the cache.
inline constexpr int kTileSide = 4, kTileStep = 3, kTileTexels = kTileSide * kTileSide;

/// A texture; the same for all lanes of an evaluation.
struct TextureView {
  TextureType type;
  WrapMode wrap;
  int32_t nearest; ///< 1: no interpolation
  int32_t width, height;
  int32_t tiles_x;         ///< bitmap8 and bitmap_float: tiles of texels in a row
  int32_t srgb;            ///< 8-bit texels are sRGB-encoded
  float to_uv[6];          ///< rows of a 2x3 affine map applied to uv
  const uint32_t* texels8; ///< R | G << 8 | B << 16 | A << 24
  const float* texels;     ///< RGBA
  float color[2][3];       ///< constant: [0]; checkerboard: both
  int32_t child[2];        ///< checkerboard: textures instead of the colours, or -1
};

/// One texture bound to a program: count 3 (colour) or 1 (luminance) slots from `slot` on.
struct TextureSlot {
  int32_t slot, count;
};
inline constexpr int kMaxTextureSlots = 16;

/// A model with its choices and the set of its textured slots.
struct ProgramView {
  const MaterialKernel* kernel;
  const float* records;
  int32_t stride;
  const int32_t* choices;
  const float* tables;
  uint64_t textured;
  int32_t delta_only; ///< 1: eval() is zero, sampling lights is useless
  int32_t texture_slots;
  TextureSlot slots[kMaxTextureSlots];
  const int32_t* textures; ///< textures[row * texture_slots + k]
};

/// A factor on the way from the root of a material tree to a leaf.
struct WeightView {
  int32_t texture; ///< -1: constant
  float constant;
  int32_t complement; ///< 1 - value
};

/// Sides of a surface a leaf scatters on.
inline constexpr int32_t kFrontSide = 1, kBackSide = 2;

/// One model at the end of a material tree.
struct LeafView {
  int32_t program; ///< -1: the null leaf, which lets light pass straight through
  int32_t row;
  int32_t sides;    ///< kFrontSide | kBackSide
  int32_t mirrored; ///< directions are mirrored (z -> -z) when seen from behind (twosided)
  int32_t first_weight, weights;
};

/// A material as shapes refer to it. Roots are numbered so that those of one class are adjacent.
struct RootView {
  int32_t first_leaf, leaves;
  int32_t class_index;
  int32_t row; ///< classes of single leaves: its record
};

/// Roots that run in one group of lanes: single leaves of one program and sidedness, or one tree.
struct ClassView {
  int32_t first_root, roots;
  int32_t single; ///< 1: a single leaf without weights
  LeafView leaf;  ///< of the first root
};

enum class LightType : int32_t { triangle, rectangle, sphere, disk, cylinder, point };

/// A light with a place: two rows.
struct alignas(64) LightRecord {
  int32_t type;      ///< LightType
  int32_t texture;   ///< radiance texture, -1: constant
  int32_t primitive; ///< triangle or quadric index
  float area;
  float p[3]; ///< first vertex, corner, centre or position
  float e1[3], e2[3];
  float n[3];        ///< unit normal of the emitting side (flat lights)
  float radiance[3]; ///< or intensity (point); a factor on the texture
  float radius;
  float uv0[2], duv1[2], duv2[2]; ///< uv = uv0 + b1 duv1 + b2 duv2
  uint32_t trail;                 ///< the way down the light BVH, one bit a level from the root
  int32_t depth;                  ///< how many levels
  float length1, length2;         ///< of the edges
  float inverse1, inverse2;       ///< of these
};
static_assert(sizeof(LightRecord) == 128);

/// A node of the light BVH: one row. Two children lie side by side.
struct alignas(64) LightNode {
  float center[3], radius2;     ///< a sphere around the lights; the radius squared
  float axis[3];                ///< of the cone of emission directions
  float cos_spread, sin_spread; ///< half angle of the normals' cone
  float cos_emission;           ///< half angle of emission beyond it
  float power;
  int32_t child; ///< first of two child nodes, or -1
  int32_t light; ///< leaf: the light record, else -1
  float reserved[3];
};
static_assert(sizeof(LightNode) == 64);

/// A rectangle of cells within which the environment differs little, chosen by an alias table: keep
/// it if a second number is below the threshold, else take the other one. Both stand in the record,
/// so that a choice costs one access.
struct alignas(32) EnvironmentLeaf {
  float threshold;
  uint32_t origin[2]; ///< own, alias: x | y << 16, in cells
  uint32_t size[2];   ///< width | height << 16
  int32_t alias;
  int32_t reserved[2];
};

/// One cell of the environment with its four corner texels: half floats over a common power of two.
/// A cell is fetched from anywhere in the image, so its size is what a fetch costs.
struct alignas(32) EnvironmentCell {
  float pdf;            ///< density over the unit square of (u, v)
  float scale;          ///< what the halves are to be multiplied with
  uint16_t texel[4][3]; ///< RGB at (0,0), (1,0), (0,1), (1,1)
};
static_assert(sizeof(EnvironmentCell) == 32);

/// The light from infinity: a constant or an image in latitude and longitude.
struct EnvironmentView {
  int32_t present;
  int32_t columns, rows; ///< of cells; 0: constant
  float radiance[3];     ///< constant; for an image: a factor
  float to_local[9], to_world[9];
  const EnvironmentCell* cells;
  const EnvironmentLeaf* leaves;
  int32_t leaf_count;
  float probability; ///< of choosing it instead of a light with a place
  float center[3], scene_radius;
};

struct CameraView {
  float to_world[12];         ///< rows of a 3x4 affine map
  float sample_to_camera[16]; ///< film position in [0,1]^2 (z 0) to a point on the near plane
  float near_clip, far_clip;
  int32_t film_width, film_height; ///< of the whole film
  int32_t crop_x, crop_y, crop_width, crop_height;
};

/// A reconstruction filter, importance-sampled: the share of |f| per axis within a distance from
/// the pixel's centre, tabulated. All filters are symmetric.
struct FilterView {
  float radius;
  int32_t cells;      ///< kFilterCells; 0: box of radius 1/2
  const float* share; ///< cells + 1 values from 0 to 1 at equidistant distances 0 .. radius
};
inline constexpr int kFilterCells = 32; ///< a power of two: kernels search by halving

struct SceneView {
  RTCSceneTy* embree;
  const TriangleRecord* triangles; ///< Embree geometry 0
  const QuadricRecord* quadrics;   ///< Embree geometry 1
  int32_t triangle_count, quadric_count;
  const TextureView* textures;
  const ProgramView* programs;
  const WeightView* weights;
  const LeafView* leaves;
  const RootView* roots;
  int32_t root_count;
  const ClassView* classes;
  int32_t class_count;
  const LightRecord* lights;
  int32_t light_count;
  const LightNode* light_nodes; ///< [0] is the root
  EnvironmentView environment;
  CameraView camera;
  FilterView filter;
};

} // namespace faceta
