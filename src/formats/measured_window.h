#pragma once

/// The two halves of the reader of Window XML.

#include "formats/measured_text.h"

#include <array>
#include <functional>

namespace faceta {

/// The text of a <ScatteringData> element and its place in the file.
struct ScatteringText {
  InputText text{}; ///< of the element; its name is the file's
  int line = 1, column = 1;

  /// InputText::error() with the position in the file.
  Error error(const char* at, const std::string& message, const std::string& hint = {}) const;
};

/// A tensor tree of one channel: node[k] >= 0 is the first of 2^dimensions children, -1 - v a leaf
/// with value v.
struct ChannelTree {
  std::vector<int32_t> nodes;
  std::vector<float> values;
  int depth = 0;
  int64_t negative = 0; ///< values below zero, now 0
};

/// Reads "{ ... }": braces with 2^dimensions children, or with the values of a grid of
/// 2^(dimensions k) cells whose last coordinate is fastest; a grid becomes k levels of nodes. Of
/// the file's position the coordinates of the light run backwards (see flip_light()).
ChannelTree parse_tensor_tree(const ScatteringText& text, int dimensions);

/// The file's first two of four coordinates are those of minus the light's direction; ours are the
/// light's. Both squares are symmetric about their centre, so the halves change places.
void flip_light(ChannelTree& tree);

/// A tree of transmission from one side as that from the other: light and viewer change places.
void transpose(std::vector<int32_t>& nodes);

/// Linear sRGB of the values of three channels.
using ChannelColor = std::function<std::array<double, 3>(const double* values)>;

/// Three trees of the same surface as one: wherever one of them branches, so does the result.
void merge_trees(const std::array<const ChannelTree*, 3>& channels, int dimensions,
                 const ChannelColor& color, std::vector<int32_t>& nodes, std::vector<float>& rgb);

} // namespace faceta
