#include "formats/measured_window.h"

#include <algorithm>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr int kDeepest = 16;
constexpr size_t kMostNodes = size_t(1) << 30;

class TreeParser {
public:
  TreeParser(const ScatteringText& text, int dimensions)
      : text_(text), scan_(text.text.text.data()), end_(scan_ + text.text.text.size()),
        dimensions_(dimensions) {}

  ChannelTree parse() {
    tree_.nodes.push_back(0);
    parse_node(0, 0);
    skip();
    if (scan_ != end_)
      throw text_.error(scan_, "more text behind the last '}' of the tensor tree");
    return std::move(tree_);
  }

private:
  void skip() {
    while (scan_ != end_ && (static_cast<unsigned char>(*scan_) <= ' ' || *scan_ == ','))
      ++scan_;
  }

  void expect(char brace) {
    skip();
    if (scan_ == end_ || *scan_ != brace)
      throw text_.error(scan_, fmt::format("'{}' expected in the tensor tree{}", brace,
                                           scan_ == end_ ? ", but it ends" : ""));
    ++scan_;
  }

  void check_depth(int depth) const {
    if (depth > kDeepest)
      throw text_.error(scan_, fmt::format("the tensor tree is deeper than {} levels", kDeepest));
  }

  int32_t add_children() {
    if (tree_.nodes.size() > kMostNodes)
      throw text_.error(scan_, fmt::format("the tensor tree has more than {} nodes", kMostNodes));
    size_t first = tree_.nodes.size();
    tree_.nodes.resize(first + (size_t(1) << dimensions_), 0);
    return static_cast<int32_t>(first);
  }

  void parse_node(size_t node, int depth) {
    check_depth(depth);
    expect('{');
    skip();
    if (scan_ != end_ && *scan_ == '{') {
      int32_t children = add_children();
      tree_.nodes[node] = children;
      for (int n = 0; n < 1 << dimensions_; ++n)
        parse_node(static_cast<size_t>(children) + static_cast<size_t>(n), depth + 1);
    } else {
      parse_grid(node, depth);
    }
    expect('}');
  }

  void parse_grid(size_t node, int depth) {
    std::vector<float> values;
    const char* start = scan_;
    for (skip(); scan_ != end_ && *scan_ != '}' && *scan_ != '{'; skip()) {
      float value = 0;
      const char* at = scan_;
      if (parse_float(scan_, end_, value) != NumberStatus::kOk)
        throw text_.error(at, fmt::format("a finite number expected, not '{}'", word_at(at, end_)));
      tree_.negative += value < 0;
      values.push_back(std::max(value, 0.0f));
    }
    int levels = 0;
    while (levels * dimensions_ < 32 && (size_t(1) << (levels * dimensions_)) < values.size())
      ++levels;
    if ((size_t(1) << (levels * dimensions_)) != values.size())
      throw text_.error(
          start, fmt::format("{} values make no grid of {} dimensions", values.size(), dimensions_),
          fmt::format("1, {}, {}, ...", 1 << dimensions_, 1 << (2 * dimensions_)));
    check_depth(depth + levels);
    tree_.depth = std::max(tree_.depth, depth + levels);
    std::array<size_t, 4> origin{};
    grid_node(node, values, levels, levels, origin);
  }

  /// The node of a block of 2^size cells a side at `origin` of a grid of 2^levels.
  void grid_node(size_t node, const std::vector<float>& values, int levels, int size,
                 const std::array<size_t, 4>& origin) {
    if (size == 0) {
      size_t index = 0;
      for (int d = 0; d < dimensions_; ++d)
        index = (index << levels) + origin[d];
      tree_.nodes[node] = -1 - static_cast<int32_t>(tree_.values.size());
      tree_.values.push_back(values[index]);
      return;
    }
    int32_t children = add_children();
    tree_.nodes[node] = children;
    for (int n = 0; n < 1 << dimensions_; ++n) {
      std::array<size_t, 4> corner = origin;
      for (int d = 0; d < dimensions_; ++d)
        corner[d] += static_cast<size_t>(n >> d & 1) << (size - 1);
      grid_node(static_cast<size_t>(children) + static_cast<size_t>(n), values, levels, size - 1,
                corner);
    }
  }

  const ScatteringText& text_;
  const char *scan_, *end_;
  int dimensions_;
  ChannelTree tree_;
};

} // namespace

Error ScatteringText::error(const char* at, const std::string& message,
                            const std::string& hint) const {
  Error local = text.error(at, message, hint);
  SourcePosition where = local.where();
  where.column += where.line == 1 ? column - 1 : 0;
  where.line += line - 1;
  return Error(message, where, hint);
}

ChannelTree parse_tensor_tree(const ScatteringText& text, int dimensions) {
  return TreeParser(text, dimensions).parse();
}

namespace {

/// Reorders the 16 children of every node: child n comes from `source(n)`.
void permute_children(std::vector<int32_t>& nodes, int (*source)(int)) {
  std::vector<int32_t> old = nodes;
  for (int32_t node : old)
    if (node >= 0)
      for (int n = 0; n < 16; ++n)
        nodes[static_cast<size_t>(node + n)] = old[static_cast<size_t>(node + source(n))];
}

} // namespace

void flip_light(ChannelTree& tree) {
  permute_children(tree.nodes, [](int n) { return n ^ 3; });
}

void transpose(std::vector<int32_t>& nodes) {
  permute_children(nodes, [](int n) { return n >> 2 | (n & 3) << 2; });
}

namespace {

/// Descends three trees at once; a tree that has come to a leaf stays there.
void merge_node(const std::array<const ChannelTree*, 3>& channels, std::array<int32_t, 3> at,
                size_t node, int dimensions, const ChannelColor& color, std::vector<int32_t>& nodes,
                std::vector<float>& rgb) {
  bool leaf = at[0] < 0 && at[1] < 0 && at[2] < 0;
  if (leaf) {
    double values[3];
    for (int c = 0; c < 3; ++c)
      values[c] = channels[c]->values[static_cast<size_t>(-1 - at[c])];
    nodes[node] = -1 - static_cast<int32_t>(rgb.size() / 3);
    for (double v : color(values))
      rgb.push_back(static_cast<float>(v));
    return;
  }
  size_t first = nodes.size();
  nodes.resize(first + (size_t(1) << dimensions), 0);
  nodes[node] = static_cast<int32_t>(first);
  for (int n = 0; n < 1 << dimensions; ++n) {
    std::array<int32_t, 3> child = at;
    for (int c = 0; c < 3; ++c)
      if (at[c] >= 0)
        child[c] = channels[c]->nodes[static_cast<size_t>(at[c] + n)];
    merge_node(channels, child, first + static_cast<size_t>(n), dimensions, color, nodes, rgb);
  }
}

} // namespace

void merge_trees(const std::array<const ChannelTree*, 3>& channels, int dimensions,
                 const ChannelColor& color, std::vector<int32_t>& nodes, std::vector<float>& rgb) {
  nodes.assign(1, 0);
  merge_node(channels, {channels[0]->nodes[0], channels[1]->nodes[0], channels[2]->nodes[0]}, 0,
             dimensions, color, nodes, rgb);
}

} // namespace faceta
