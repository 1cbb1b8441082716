#pragma once

#include "formats/mitsuba_scene.h"
#include "spectrum/spectrum_curve.h"

#include <functional>
#include <map>
#include <unordered_map>
#include <unordered_set>

/// From the property tree of a scene file to a Scene. One function per kind of plugin; each reads
/// the properties it knows and ends with finish(), which reports the others.
namespace faceta::mitsuba {

/// What a colour stands for (SpectrumUse), and whether one number of it is wanted (alpha, opacity,
/// weight): Mitsuba then takes the mean of a colour, and its checkerboard swaps its two colours
/// (3.9.1; the judge of this reader).
struct ColorUse {
  SpectrumUse spectrum = SpectrumUse::reflectance;
  bool scalar = false;
};

class Reader {
public:
  /// `scene` may be null: then textures are an Error.
  Reader(Scene* scene, const ReadOptions& options) : scene_(scene), options_(options) {}

  /// A root <scene> with everything in it.
  void read_scene(const xml::Node& root);
  /// A bsdf and what is nested in it; once per node.
  std::shared_ptr<MaterialNode> read_material(const xml::NodePtr& node);

private:
  // mitsuba_scene.cpp
  void read_child(const xml::NodePtr& child);
  void read_top_emitter(const xml::NodePtr& node);

  // mitsuba_bsdf.cpp
  std::shared_ptr<MaterialNode> read_measured_alias(const xml::Node& node, const Model& measured);
  std::shared_ptr<MaterialNode> read_model(const xml::Node& node, const Model& model);
  void read_parameter(const xml::Node& node, const ParamInfo& parameter, MaterialNode& material);
  void read_textured_parameter(const xml::Node& node, const ParamInfo& parameter,
                               MaterialNode& material);
  std::shared_ptr<MaterialNode> read_twosided(const xml::Node& node);
  std::shared_ptr<MaterialNode> read_mask(const xml::Node& node);
  std::shared_ptr<MaterialNode> read_blend(const xml::Node& node);
  std::vector<std::shared_ptr<MaterialNode>> read_nested_materials(const xml::Node& node);
  /// The same number for materials that behave alike.
  int material_number(const MaterialNode& material);
  /// The scene's index of a material; equal ones share it.
  int material_index(const std::shared_ptr<MaterialNode>& material, const SourcePosition& where);

  // mitsuba_texture.cpp
  /// A colour, number, spectrum or texture property; `fallback` in all channels if absent.
  TexturedValue read_color(const xml::Node& node, std::string_view name, const ColorUse& use,
                           double fallback);
  /// The same, where it must not vary in space.
  std::array<double, 3> read_constant_color(const xml::Node& node, std::string_view name,
                                            const ColorUse& use, double fallback);
  TexturedValue read_texture(const xml::NodePtr& node, const ColorUse& use);
  TexturedValue read_texture_plugin(const xml::Node& node, const ColorUse& use);
  TexturedValue read_d65(const xml::Node& node, const ColorUse& use);
  int read_bitmap_texture(const xml::Node& node);
  int read_checkerboard(const xml::Node& node, const ColorUse& use);
  int texture_index(const TextureDesc& texture, const SourcePosition& where);
  Scene& need_scene(const SourcePosition& where) const;

  // mitsuba_shape.cpp
  /// A shape read but for its mesh file.
  struct PendingShape {
    ShapeDesc desc;
    SourcePosition where;
    std::function<Mesh()> load; ///< empty for analytic shapes
    bool rectangle = false;
    std::function<void(Scene&, const ShapeDesc&)> add; ///< analytic shapes
  };
  void read_shape(const xml::NodePtr& node);
  void read_shape_children(const xml::Node& node, ShapeDesc& shape);
  /// Returns the names of the properties the shape may have.
  std::vector<std::string> read_quadric(const xml::Node& node, const ToWorld& to_world, bool flip,
                                        PendingShape& shape);
  const xml::NodePtr& default_material(bool emits, const SourcePosition& where);
  void load_pending_shapes();

  // mitsuba_emitter.cpp
  std::shared_ptr<AreaEmitter> read_area_emitter(const xml::Node& node);
  void read_point_light(const xml::Node& node);
  void read_constant_environment(const xml::Node& node);
  void read_envmap(const xml::Node& node);
  void set_environment(const xml::Node& node, const EnvironmentDesc& environment);
  double read_sampling_weight(const xml::Node& node);
  void refuse_emitter_children(const xml::Node& node);

  // mitsuba_sensor.cpp
  void read_sensor(const xml::Node& node);
  CameraDesc read_camera(const xml::Node& node, const FilmDesc& film);
  FilmDesc read_film(const xml::Node& node);
  FilterDesc read_filter(const xml::Node& node);
  SamplerDesc read_sampler(const xml::Node& node);

  // mitsuba_integrator.cpp
  IntegratorDesc read_integrator(const xml::Node& node);
  IntegratorDesc read_moment(const xml::Node& node);

  /// Reports what nobody read; `known` are the names that would have been right.
  void finish(const xml::Node& node, const std::vector<std::string>& known);
  void warn(const SourcePosition& where, const std::string& message) const;

  Scene* scene_;
  const ReadOptions& options_;
  std::unordered_map<const xml::Node*, std::shared_ptr<MaterialNode>> materials_;
  std::unordered_map<const MaterialNode*, int> material_numbers_;
  std::map<std::string, int> material_keys_; ///< what is in a material, to its number
  std::map<int, int> material_indices_;      ///< number to the scene's index
  xml::NodePtr default_materials_[2];        ///< of shapes that do not emit, and that do
  std::map<std::pair<const xml::Node*, bool>, TexturedValue> textures_; ///< by node and scalar use
  std::map<std::string, int> texture_indices_;                          ///< by what is in them
  std::map<std::string, std::shared_ptr<const Bitmap>> bitmaps_;        ///< by canonical path
  std::vector<PendingShape> shapes_;
  std::unordered_set<const xml::Node*> attached_emitters_;
  std::vector<xml::NodePtr> free_area_emitters_;
  const xml::Node* environment_ = nullptr;
  const xml::Node* integrator_ = nullptr;
};

/// An Error about a plugin that is none of `supported`: "not supported yet" if the scene contract
/// has it, else "unknown", with a suggestion.
Error unsupported_plugin(const xml::Node& node, const std::vector<std::string>& supported);

/// A float property that must be finite and positive (not negative).
double positive(const xml::Node& node, std::string_view name, double fallback);
double non_negative(const xml::Node& node, std::string_view name, double fallback);

/// Lower case (ASCII).
std::string lower(std::string text);

/// Runs f; an Error without a place gets this one.
template <class F> auto located(const SourcePosition& where, F f) {
  try {
    return f();
  } catch (const Error& error) {
    if (!error.where().file.empty())
      throw;
    throw Error(error.message(), where, error.hint());
  }
}

} // namespace faceta::mitsuba
