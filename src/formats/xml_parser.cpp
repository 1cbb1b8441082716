#include "formats/xml_parser.h"

#include "formats/xml_values.h"

#include <algorithm>
#include <fmt/format.h>
#include <system_error>

namespace faceta::xml {

namespace {

constexpr size_t kMaxTotalBytes = size_t{1} << 30;
constexpr size_t kMaxIncludes = 10'000;
constexpr size_t kMaxProperties = 8'000'000;

const std::vector<std::string> kObjectTags = {
    "bsdf",    "emitter", "film",   "integrator", "medium",   "phase",   "rfilter",
    "sampler", "scene",   "sensor", "shape",      "spectrum", "texture", "volume"};

const std::vector<std::string> kOtherTags = {"alias",    "boolean", "default",   "float", "include",
                                             "integer",  "path",    "point",     "ref",   "rgb",
                                             "spectrum", "string",  "transform", "vector"};

const std::vector<std::string> kTransformTags = {"lookat", "matrix", "rotate", "scale",
                                                 "translate"};

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_object(const Element& element) {
  if (element.tag == "spectrum")
    return element.find("type") != nullptr;
  return contains(kObjectTags, element.tag);
}

std::string tag_hint(const std::string& tag) {
  if (tag == "srgb")
    return "use <rgb>";
  if (tag == "blackbody")
    return "use <spectrum type=\"blackbody\">";
  if (tag == "lookAt")
    return "tags are case-sensitive: use <lookat>";
  std::vector<std::string> known = kObjectTags;
  known.insert(known.end(), kOtherTags.begin(), kOtherTags.end());
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  return suggestion(tag, known);
}

} // namespace

const Element::Attribute* Element::find(std::string_view name) const {
  for (const Attribute& attribute : attributes)
    if (attribute.name == name)
      return &attribute;
  return nullptr;
}

std::string Element::name() const {
  const Attribute* attribute = find("name");
  return attribute ? attribute->value : std::string();
}

Parser::Parser(const ParseOptions& options) : options_(options), parameters_(options.defines) {}

Parser::~Parser() {
  if (done_)
    return;
  // After an error the references may form cycles or long chains: cut all of them while every node
  // is still held here, so that nothing leaks and no destructor recurses.
  for (const NodePtr& node : nodes_)
    node->properties.clear();
}

NodePtr Parser::parse_file(const std::filesystem::path& path) {
  std::error_code code;
  std::string text = read_text_file(path, kMaxXmlBytes);
  open_files_.push_back(std::filesystem::weakly_canonical(path, code));
  FileState& file = open(path.string(), std::move(text), nullptr);
  if (path.has_parent_path())
    file.own_folders.push_back(path.parent_path());
  return finish(read_root(file, 0));
}

NodePtr Parser::parse_string(std::string_view text, const std::string& name) {
  if (text.size() > kMaxXmlBytes)
    throw Error(
        fmt::format("the scene has {} bytes, at most {} are read", text.size(), kMaxXmlBytes),
        {name});
  open_files_.emplace_back();
  return finish(read_root(open(name, std::string(text), nullptr), 0));
}

NodePtr Parser::finish(NodePtr root) {
  parameters_.check_unused(options_.permissive, options_.warn);
  resolve_references();
  check_cycles();
  set_search_folders();
  done_ = true;
  return root;
}

FileState& Parser::open(std::string name, std::string text, FileState* parent) {
  bytes_ += text.size();
  if (bytes_ > kMaxTotalBytes)
    throw Error(
        fmt::format("a scene's files may not have more than {} bytes together", kMaxTotalBytes),
        {name});
  sources_.push_back(std::make_unique<Source>(std::move(name), std::move(text)));
  files_.push_back(std::make_unique<FileState>());
  FileState& file = *files_.back();
  file.source = sources_.back().get();
  file.parent = parent;
  file.folders = std::make_shared<std::vector<std::filesystem::path>>();
  return file;
}

NodePtr Parser::read_root(FileState& file, int depth) {
  Element element = read_element(file, file.source->root());
  check_version(file, element);
  if (!is_object(element))
    throw Error(fmt::format("the root element must be an object, not <{}>", element.tag),
                element.where, tag_hint(element.tag));
  NodePtr root = read_object(file, element, depth, true, file.parent != nullptr);
  file.source = nullptr;
  sources_.pop_back();
  open_files_.pop_back();
  return root;
}

void Parser::check_version(FileState& file, const Element& element) {
  const Element::Attribute* attribute = element.find("version");
  if (!attribute)
    throw Error(fmt::format("the root element <{}> has no version", element.tag), element.where,
                "write version=\"3.0.0\"");
  int64_t numbers[3] = {0, 0, 0};
  std::string_view rest = attribute->value;
  size_t count = 0;
  bool good = true;
  for (bool more = true; more && good; ++count) {
    size_t dot = rest.find('.');
    std::optional<int64_t> number = parse_integer(rest.substr(0, dot));
    good = count < 3 && number && *number >= 0;
    if (good)
      numbers[count] = *number;
    more = dot != rest.npos;
    rest.remove_prefix(more ? dot + 1 : 0);
  }
  if (!good || count != 3)
    throw Error(fmt::format("'{}' is not a version", attribute->value), attribute->value_where,
                "write three numbers, such as 3.0.0");
  file.upgrade = numbers[0] < 2;
}

Element Parser::read_element(FileState& file, pugi::xml_node node) {
  Element element;
  element.node = node;
  element.tag = node.name();
  element.where = file.source->position(node);
  for (pugi::xml_attribute attribute : node.attributes()) {
    Element::Attribute read;
    read.name = attribute.name();
    read.name_where = file.source->position(attribute.name(), node);
    read.value_where = file.source->position(attribute.value(), node);
    std::string_view value = attribute.value();
    if (element.find(read.name))
      throw Error(fmt::format("attribute '{}' is given twice in <{}>", read.name, element.tag),
                  read.name_where);
    if (value.find('$') == value.npos)
      read.value = value;
    else
      read.value = parameters_.expand(value, read.value_where);
    element.attributes.push_back(std::move(read));
  }
  return element;
}

void Parser::check_attributes(const Element& element,
                              std::initializer_list<std::string_view> required,
                              std::initializer_list<std::string_view> optional) {
  std::vector<std::string> known(required.begin(), required.end());
  known.insert(known.end(), optional.begin(), optional.end());
  for (const Element::Attribute& attribute : element.attributes)
    if (!contains(known, attribute.name))
      throw Error(fmt::format("unexpected attribute '{}' in <{}>", attribute.name, element.tag),
                  attribute.name_where, suggestion(attribute.name, known));
  for (std::string_view name : required)
    if (!element.find(name))
      throw Error(fmt::format("<{}> needs the attribute '{}'", element.tag, name), element.where);
}

void Parser::check_childless(const Element& element, FileState& file) {
  for (pugi::xml_node child : element.node.children()) {
    if (child.type() == pugi::node_element)
      throw Error(fmt::format("<{}> cannot stand inside <{}>", child.name(), element.tag),
                  file.source->position(child));
    warn_about_text(file, child);
  }
}

NodePtr Parser::read_object(FileState& file, const Element& element, int depth, bool is_root,
                            bool is_included) {
  if (depth >= kMaxDepth)
    throw Error(fmt::format("objects are nested deeper than {}", kMaxDepth), element.where);
  bool is_root_scene = is_root && element.tag == "scene";
  if (is_root_scene)
    check_attributes(element, {"version"}, {"type", "id", "name"});
  else if (is_root)
    check_attributes(element, {"version", "type"}, {"id", "name"});
  else
    check_attributes(element, {"type"}, {"id", "name"});

  auto node = std::make_shared<Node>();
  nodes_.push_back(node);
  node->tag = element.tag;
  node->where = element.where;
  node->folders = file.folders;
  const Element::Attribute* type = element.find("type");
  node->type = type ? type->value : "scene";
  if (node->type.empty())
    throw Error(fmt::format("the type of <{}> is empty", element.tag), element.where);
  if (const Element::Attribute* id = element.find("id"))
    node->id = id->value;
  // an included scene dissolves in its parent, and its id with it
  if (!(is_included && is_root && node->type == "scene"))
    register_id(node);

  Frame frame;
  frame.node = node;
  frame.file = &file;
  frame.depth = depth;
  frame.is_root = is_root;
  read_children(frame, element.node);
  if (file.upgrade)
    upgrade_names(frame);
  return node;
}

void Parser::read_children(Frame& frame, pugi::xml_node node) {
  for (pugi::xml_node child : node.children()) {
    if (child.type() == pugi::node_element)
      read_child(frame, read_element(*frame.file, child));
    else
      warn_about_text(*frame.file, child);
  }
}

void Parser::read_child(Frame& frame, const Element& element) {
  if (is_object(element)) {
    NodePtr child = read_object(*frame.file, element, frame.depth + 1, false, false);
    add_object(frame, element.name(), std::move(child), element.where);
    return;
  }
  if (element.tag == "transform") {
    read_transform(frame, element);
    return;
  }
  if (contains(kTransformTags, element.tag))
    throw Error(fmt::format("<{}> can only stand inside a <transform>", element.tag),
                element.where);
  if (!contains(kOtherTags, element.tag))
    throw Error(fmt::format("unknown element <{}>", element.tag), element.where,
                tag_hint(element.tag));
  check_childless(element, *frame.file);
  if (!read_value(frame, element))
    read_directive(frame, element);
}

bool Parser::read_directive(Frame& frame, const Element& element) {
  if (element.tag == "ref") {
    check_attributes(element, {"id"}, {"name"});
    add_object(frame, element.name(), element.value("id"), element.where);
  } else if (element.tag == "default") {
    check_attributes(element, {"name", "value"}, {});
    parameters_.add_default(element.value("name"), element.value("value"), element.where);
  } else if (element.tag == "include") {
    read_include(frame, element);
  } else if (element.tag == "alias") {
    read_alias(element);
  } else if (element.tag == "path") {
    read_path(frame, element);
  } else {
    return false;
  }
  return true;
}

void Parser::read_alias(const Element& element) {
  check_attributes(element, {"id", "as"}, {});
  const std::string &id = element.value("id"), &as = element.value("as");
  if (as.empty())
    throw Error("the new id of an <alias> is empty", element.where);
  auto existing = ids_.find(id);
  if (existing == ids_.end()) {
    std::vector<std::string> known;
    for (const auto& [name, node] : ids_)
      known.push_back(name);
    std::sort(known.begin(), known.end());
    std::string hint = suggestion(id, known);
    throw Error(fmt::format("<alias> of unknown id '{}'", id), element.value_where("id"),
                "the object must stand before its alias" + (hint.empty() ? "" : "; " + hint));
  }
  NodePtr node = existing->second;
  auto [taken, is_new] = ids_.try_emplace(as, node);
  if (!is_new) {
    const SourcePosition& at = taken->second->where;
    throw Error(
        fmt::format("id '{}' of an <alias> is taken: {}:{}:{}", as, at.file, at.line, at.column),
        element.value_where("as"));
  }
}

void Parser::register_id(const NodePtr& node) {
  if (node->id.empty())
    return;
  auto [taken, is_new] = ids_.try_emplace(node->id, node);
  if (is_new)
    return;
  const SourcePosition& at = taken->second->where;
  throw Error(fmt::format("id '{}' is used twice: before at {}:{}:{}", node->id, at.file, at.line,
                          at.column),
              node->where);
}

void Parser::add(Frame& frame, std::string name, Type type, Value value,
                 const SourcePosition& where) {
  if (++properties_ > kMaxProperties)
    throw Error(fmt::format("the scene has more than {} properties", kMaxProperties), where);
  std::vector<Property>& properties = frame.node->properties;
  if (!frame.names.insert(name).second) {
    auto before = std::find_if(properties.begin(), properties.end(),
                               [&](const Property& p) { return p.name == name; });
    std::string message = fmt::format("property '{}' of {} is set twice: before at {}:{}:{}", name,
                                      frame.node->describe(), before->where.file,
                                      before->where.line, before->where.column);
    bool both_objects = before->type == Type::object && type == Type::object;
    if (!(options_.permissive && both_objects))
      throw Error(message, where);
    warn_at(where, message);
    before->value = std::move(value);
    before->where = where;
    return;
  }
  properties.push_back({std::move(name), type, std::move(value), where});
}

void Parser::add_object(Frame& frame, std::string name, Value value, const SourcePosition& where) {
  if (name.empty())
    name = fmt::format("_arg_{}", frame.next_argument++);
  add(frame, std::move(name), Type::object, std::move(value), where);
}

void Parser::read_include(Frame& frame, const Element& element) {
  check_attributes(element, {"filename"}, {"name"});
  if (++includes_ > kMaxIncludes)
    throw Error(fmt::format("more than {} files are included", kMaxIncludes), element.where);
  std::filesystem::path path =
      resolve(*frame.file, element.value("filename"), element.value_where("filename"));
  std::error_code code;
  std::filesystem::path canonical = std::filesystem::weakly_canonical(path, code);
  if (std::find(open_files_.begin(), open_files_.end(), canonical) != open_files_.end())
    throw Error(fmt::format("'{}' includes itself", path.string()), element.where);
  if (open_files_.size() >= static_cast<size_t>(kMaxIncludeDepth))
    throw Error(fmt::format("includes are nested deeper than {} files", kMaxIncludeDepth),
                element.where);
  std::string text = read_text_file(path, kMaxXmlBytes, element.where);
  NodePtr root;
  try {
    FileState& file = open(path.string(), std::move(text), frame.file);
    open_files_.push_back(std::move(canonical));
    if (path.has_parent_path())
      file.own_folders.push_back(path.parent_path());
    root = read_root(file, frame.depth + 1);
  } catch (const Error& error) {
    std::string place = fmt::format("included from {}:{}:{}", element.where.file,
                                    element.where.line, element.where.column);
    throw Error(error.message(), error.where(),
                error.hint().empty() ? place : error.hint() + "; " + place);
  }
  if (root->type == "scene")
    splice(frame, *root);
  else
    add_object(frame, element.name(), std::move(root), element.where);
}

void Parser::splice(Frame& frame, Node& scene) {
  for (Property& property : scene.properties) {
    if (property.type == Type::object && is_automatic_name(property.name))
      add_object(frame, {}, std::move(property.value), property.where);
    else
      add(frame, std::move(property.name), property.type, std::move(property.value),
          property.where);
  }
  scene.properties.clear();
}

void Parser::read_path(Frame& frame, const Element& element) {
  check_attributes(element, {"value"}, {});
  if (!frame.is_root)
    throw Error("<path> can only stand directly in the root element", element.where);
  std::filesystem::path path =
      resolve(*frame.file, element.value("value"), element.value_where("value"));
  std::vector<std::filesystem::path>& folders = frame.file->own_folders;
  folders.insert(folders.begin(), path);
}

std::filesystem::path Parser::resolve(const FileState& file, const std::string& name,
                                      const SourcePosition& where) const {
  std::vector<std::filesystem::path> folders;
  for (const FileState* state = &file; state; state = state->parent)
    folders.insert(folders.end(), state->own_folders.begin(), state->own_folders.end());
  folders.insert(folders.end(), options_.search_paths.begin(), options_.search_paths.end());
  return find_file(name, folders, where);
}

void Parser::set_search_folders() {
  const std::vector<std::filesystem::path>& root = files_.front()->own_folders;
  for (const std::unique_ptr<FileState>& file : files_) {
    std::vector<std::filesystem::path>& folders = *file->folders;
    folders = root;
    folders.insert(folders.end(), options_.search_paths.begin(), options_.search_paths.end());
    for (const FileState* state = file.get(); state->parent; state = state->parent)
      folders.insert(folders.end(), state->own_folders.begin(), state->own_folders.end());
  }
}

void Parser::warn_about_text(FileState& file, pugi::xml_node node) {
  if (node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata)
    warn_at(file.source->position(node.value(), node.parent()), "text between elements is ignored");
}

void Parser::warn_at(const SourcePosition& where, const std::string& message) const {
  if (options_.warn)
    options_.warn(
        fmt::format("{}:{}:{}: warning: {}", where.file, where.line, where.column, message));
}

NodePtr parse_scene_file(const std::filesystem::path& path, const ParseOptions& options) {
  return Parser(options).parse_file(path);
}

NodePtr parse_scene_string(std::string_view text, const std::string& name,
                           const ParseOptions& options) {
  return Parser(options).parse_string(text, name);
}

} // namespace faceta::xml
