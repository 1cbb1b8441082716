#pragma once

#include "base/error.h"

#include <array>
#include <climits>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// The syntax of Mitsuba 3 scene files: text in, a tree of named and typed properties out, and
/// back. What a plugin does with its properties is not known here. Behaviour follows Mitsuba
/// 3.9.1; where this reader differs on purpose, the declaration concerned says so.
namespace faceta::xml {

struct Node;
using NodePtr = std::shared_ptr<Node>;
using Numbers3 = std::array<double, 3>;
/// 4x4 matrix, row-major: m[4 * row + column], points are columns, the last row is (0, 0, 0, 1).
using Matrix4 = std::array<double, 16>;
/// 3x3 matrix, row-major, acting on (u, v, 1).
using Matrix3 = std::array<double, 9>;

inline constexpr Matrix4 kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// The content of a <spectrum value="..."> or <spectrum filename="...">.
struct SpectrumValue {
  std::vector<double> wavelengths; ///< nm, strictly increasing; empty: uniform
  std::vector<double> values;      ///< as many as wavelengths, or one if uniform

  bool is_uniform() const { return wavelengths.empty(); }
  /// Samples are equally spaced, up to 1e-3 of the first step.
  bool is_regular() const;
};

enum class Type {
  boolean,
  integer,
  float_,
  string,
  vector,
  point,
  rgb,
  spectrum,
  transform,
  object
};

/// "boolean", "integer", "float", ...: the name of the type, which is also its tag.
const char* type_name(Type type);

/// vector, point and rgb hold Numbers3. While a file is being read an unresolved reference is an
/// object that holds the id as a string; a tree that parse_scene_* returned has none.
using Value =
    std::variant<bool, int64_t, double, std::string, Numbers3, SpectrumValue, Matrix4, NodePtr>;

struct Property {
  std::string name; ///< `_arg_N` for objects without a name
  Type type = Type::string;
  Value value;
  SourcePosition where;
  mutable bool queried = false;

  /// The nested object, or null if this is not an object.
  NodePtr object() const;
};

/// One object of a scene file: <scene>, <bsdf>, <shape>, ... and <spectrum type="...">.
///
/// Getters mark what they read; check_all_queried() then reports what nobody asked for. A getter
/// without a default throws an Error that names the missing property; every getter throws an Error
/// at the property's position if its type is wrong. Integers are accepted as floats, never the
/// other way round; nothing else is converted unless said below.
struct Node {
  std::string tag;  ///< scene, bsdf, emitter, film, ...
  std::string type; ///< plugin name; "scene" for the root scene
  std::string id;   ///< empty if none
  SourcePosition where;
  std::vector<Property> properties; ///< in order of appearance, nested objects among them
  /// Where resolve() looks, in order; shared by all nodes of one file. May be null.
  std::shared_ptr<const std::vector<std::filesystem::path>> folders;

  bool has(std::string_view name) const { return find(name) != nullptr; }
  /// The property of that name or null. Does not mark it as queried.
  const Property* find(std::string_view name) const;
  /// Type of a property, empty if there is none. Does not mark it as queried.
  std::optional<Type> type_of(std::string_view name) const;
  /// Names of all properties, in order.
  std::vector<std::string> names() const;
  /// Marks a property as queried, without reading it.
  void mark(std::string_view name) const;
  /// Marks every property as queried (for a plugin that is known but ignored).
  void mark_all() const;

  bool get_boolean(std::string_view name) const;
  bool get_boolean(std::string_view name, bool fallback) const;
  double get_float(std::string_view name) const;
  double get_float(std::string_view name, double fallback) const;
  /// A value outside [low, high] is an error.
  int get_integer(std::string_view name) const;
  int get_integer(std::string_view name, int fallback, int low = INT_MIN, int high = INT_MAX) const;
  int64_t get_integer64(std::string_view name, int64_t fallback, int64_t low, int64_t high) const;
  std::string get_string(std::string_view name) const;
  std::string get_string(std::string_view name, std::string_view fallback) const;
  /// A string that must be one of `choices`.
  std::string get_choice(std::string_view name, std::string_view fallback,
                         const std::vector<std::string>& choices) const;
  /// Points and vectors stand for each other.
  Numbers3 get_point(std::string_view name) const;
  Numbers3 get_point(std::string_view name, const Numbers3& fallback) const;
  Numbers3 get_vector(std::string_view name) const;
  Numbers3 get_vector(std::string_view name, const Numbers3& fallback) const;
  /// An <rgb>, or a vector. Not range-checked.
  Numbers3 get_rgb(std::string_view name) const;
  Numbers3 get_rgb(std::string_view name, const Numbers3& fallback) const;
  const SpectrumValue& get_spectrum(std::string_view name) const;
  Matrix4 get_transform(std::string_view name) const;
  Matrix4 get_transform(std::string_view name, const Matrix4& fallback) const;
  /// The planar part of a transform (rows and columns x, y and the translation), as `to_uv` uses
  /// it.
  Matrix3 get_transform_2d(std::string_view name) const;
  /// A string property as a file that exists: see resolve(). Errors point at the property.
  std::filesystem::path get_file(std::string_view name) const;

  /// The nested object of that name; null if absent. It is an error if the property is no object.
  NodePtr get_object(std::string_view name) const;
  /// All nested objects of a tag in order, marked as queried. "texture" includes <spectrum type>.
  std::vector<NodePtr> objects(std::string_view tag) const;
  /// All nested objects in order, marked as queried.
  std::vector<NodePtr> objects() const;
  /// Same as objects(tag), with the properties they came in (for names and positions).
  std::vector<const Property*> object_properties(std::string_view tag) const;

  /// The file a name in this node means. An absolute name is itself. Otherwise, as in Mitsuba, the
  /// root file's <path> folders (latest first) and folder, then ParseOptions::search_paths; then,
  /// unlike Mitsuba, the <path>s and folder of the included file that the node came from; last the
  /// working folder. Error, listing where it looked, if there is no such file.
  std::filesystem::path resolve(const std::string& filename) const;

  /// "bsdf of type 'diffuse'", with its id if it has one.
  std::string describe() const;
  /// An Error at this node.
  Error error(const std::string& message, const std::string& hint = {}) const;
  /// An Error at one property, or at this node if there is no such property.
  Error error_at(std::string_view name, const std::string& message,
                 const std::string& hint = {}) const;

  /// Adds or replaces a property. For building trees to write.
  Property& set(std::string name, Type type, Value value);
  /// Adds a nested object; an empty name becomes the next free `_arg_N`.
  Property& add_object(NodePtr object, std::string name = {});
};

/// True if a name is one made for an unnamed object (`_arg_N`).
bool is_automatic_name(std::string_view name);

using Warn = std::function<void(const std::string&)>;

struct ParseOptions {
  /// -Dname=value: wins over <default>. Unused ones are errors.
  std::vector<std::pair<std::string, std::string>> defines;
  /// Unused defines and two objects of one name (the later counts) are warnings, not errors.
  bool permissive = false;
  /// Folders to look for files in, after those the scene names.
  std::vector<std::filesystem::path> search_paths;
  /// Gets "file:line:column: warning: ..."; may be empty.
  Warn warn;
};

/// Largest scene file, bytes.
inline constexpr size_t kMaxXmlBytes = size_t{256} << 20;
/// Deepest nesting of objects, includes and references taken together.
inline constexpr int kMaxDepth = 256;
/// Files open at once: the scene file and what it includes.
inline constexpr int kMaxIncludeDepth = 15;

/// Reads a scene file and all it includes; references are resolved, so that every use of an id
/// holds the same Node, and there are no cycles. Reading is stricter than Mitsuba where it would
/// drop something without a word: an empty or garbled number, an attribute given twice, a second
/// root element, elements inside transform operations, two properties whose names meet after the
/// upgrade from version 1. References may not chain deeper than kMaxDepth.
/// @throws Error for anything malformed, at the file, line and column it was found.
NodePtr parse_scene_file(const std::filesystem::path& path, const ParseOptions& options = {});

/// The same for text in memory. `name` stands for the file in messages; files are looked for in
/// ParseOptions::search_paths and the working folder.
NodePtr parse_scene_string(std::string_view text, const std::string& name = "<string>",
                           const ParseOptions& options = {});

/// Throws (or, if permissive, warns) if a property of this node was never queried. Nested nodes are
/// not visited. `known_names` are the names that would have been right, for the suggestion.
void check_all_queried(const Node& node, bool permissive = false,
                       const std::vector<std::string>& known_names = {}, const Warn& warn = {});

/// The tree as a version 3 scene file; numbers are the shortest that read back to the same bits.
/// An object that occurs more than once is written at its first place and referred to by id
/// afterwards (ids are made up where missing or ambiguous). File names are written as they stand.
/// @throws Error if the tree has a cycle, a null object or a value that contradicts its type.
std::string write_xml(const Node& root);

} // namespace faceta::xml
