/// Sides and azimuths, as Radiance has them (bsdf_m.c, bsdf_t.c): "Front" in the file is where the
/// light comes from that enters a room, and the normal points into the room. So blocks named Front
/// are those of light from z < 0: kBackReflection, kBackTransmission. The incident basis of a Klems
/// matrix holds the azimuth of minus the light's direction; cells here hold the light's own.

#include "formats/measured_common.h"
#include "formats/measured_text_formats.h"
#include "formats/measured_window.h"
#include "formats/xml_source.h"
#include "spectrum/cie.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>

namespace faceta {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMostRings = 100, kMostCells = 2000, kMostBasis = 20000;

std::string trimmed(std::string_view text) {
  auto blank = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
  while (!text.empty() && blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && blank(text.back()))
    text.remove_suffix(1);
  return std::string(text.substr(0, 200));
}

std::string lower(std::string text) {
  for (char& c : text)
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// The quantity of a <WavelengthData>: which channel its blocks are.
enum Channel { kY, kX, kZ, kU, kV, kChannels };

struct Block {
  pugi::xml_node node;
  MeasuredPass pass;
  Channel channel;
};

class WindowReader {
public:
  WindowReader(const InputText& input, const MeasuredOptions& options)
      : input_(input), source_(input.name, std::string(input.text)) {
    expect_one_coloured_material(input, options);
  }

  MeasuredFile read() {
    MeasuredInfo info;
    pugi::xml_node layer = need(need(source_.root(), "Optical"), "Layer");
    pugi::xml_node definition = need(layer, "DataDefinition");
    if (pugi::xml_node material = layer.child("Material"))
      info.description = shown_text(trimmed(trimmed(material.child_value("Name")) + " " +
                                            trimmed(material.child_value("Manufacturer"))));
    pugi::xml_node structure = need(definition, "IncidentDataStructure");
    std::string kind = trimmed(structure.child_value());
    collect_blocks(layer);
    if (kind == "Columns" || kind == "Rows")
      return read_klems(std::move(info), definition, kind == "Rows");
    if (kind == "TensorTree3" || kind == "TensorTree4")
      return read_tree(std::move(info), kind == "TensorTree3" ? 3 : 4);
    throw error(structure, fmt::format("unknown IncidentDataStructure '{}'", kind),
                "Columns, Rows, TensorTree3 or TensorTree4");
  }

private:
  Error error(pugi::xml_node node, const std::string& message, const std::string& hint = {}) {
    return Error(message, source_.position(node), hint);
  }

  pugi::xml_node need(pugi::xml_node parent, const char* name) {
    pugi::xml_node child = parent.child(name);
    if (!child)
      throw error(parent, fmt::format("<{}> has no <{}>", parent.name(), name));
    return child;
  }

  double number(pugi::xml_node node, double least, double most) {
    InputText text{node.child_value(), input_.name};
    TextScanner scanner(text, 0);
    try {
      double value = scanner.number(node.name());
      if (value < least || value > most || !scanner.at_end())
        throw Error(fmt::format("a number from {} to {} expected", least, most));
      return value;
    } catch (const Error& e) {
      throw error(node, e.message(), e.hint());
    }
  }

  ScatteringText scattering_text(pugi::xml_node block) {
    pugi::xml_node data = need(block, "ScatteringData");
    const char* text = data.child_value();
    SourcePosition where = source_.position(text, data);
    return {{text, input_.name}, where.line, where.column};
  }

  /// All blocks that say something about visible light.
  void collect_blocks(pugi::xml_node layer) {
    std::string others;
    for (pugi::xml_node data : layer.children("WavelengthData")) {
      std::string name = trimmed(need(data, "Wavelength").child_value());
      const char* names[] = {"visible", "cie-x", "cie-z", "cie-u", "cie-v"};
      auto found = std::find(std::begin(names), std::end(names), lower(name));
      if (found == std::end(names)) {
        others += (others.empty() ? "" : ", ") + name.substr(0, 40);
        continue;
      }
      for (pugi::xml_node block : data.children("WavelengthDataBlock"))
        add_block(block, static_cast<Channel>(found - std::begin(names)));
    }
    bool visible =
        std::any_of(blocks_.begin(), blocks_.end(), [](const Block& b) { return b.channel == kY; });
    if (!visible)
      throw error(layer, "no WavelengthData for Visible",
                  others.empty() ? "" : "the file has " + others.substr(0, 200));
  }

  void add_block(pugi::xml_node node, Channel channel) {
    pugi::xml_node direction = need(node, "WavelengthDataDirection");
    std::string name = trimmed(direction.child_value());
    const std::map<std::string, MeasuredPass> passes = {{"reflection back", kFrontReflection},
                                                        {"transmission back", kFrontTransmission},
                                                        {"reflection front", kBackReflection},
                                                        {"transmission front", kBackTransmission}};
    auto pass = passes.find(lower(name));
    if (pass == passes.end())
      throw error(direction, fmt::format("unknown WavelengthDataDirection '{}'", name),
                  "Transmission Front, Transmission Back, Reflection Front or Reflection Back");
    for (const Block& other : blocks_)
      if (other.pass == pass->second && other.channel == channel)
        throw error(node, fmt::format("a second block of '{}'", name));
    blocks_.push_back({node, pass->second, channel});
  }

  const Block* find(MeasuredPass pass, Channel channel) const {
    for (const Block& block : blocks_)
      if (block.pass == pass && block.channel == channel)
        return &block;
    return nullptr;
  }

  // -- Klems matrices ---------------------------------------------------------------------------

  KlemsBasis read_basis(pugi::xml_node node) {
    KlemsBasis basis{{0}, {}};
    for (pugi::xml_node ring : node.children("AngleBasisBlock")) {
      pugi::xml_node bounds = need(ring, "ThetaBounds");
      pugi::xml_node lower_bound = need(bounds, "LowerTheta"), upper = need(bounds, "UpperTheta");
      double low = number(lower_bound, 0, 90) * kDegree, high = number(upper, 0, 90) * kDegree;
      if (std::abs(low - basis.theta.back()) > 1e-6 || high <= low)
        throw error(bounds,
                    "rings of an angle basis must follow one another, from 0 to 90 degrees");
      pugi::xml_node count = need(ring, "nPhis");
      double cells = number(count, 1, kMostCells);
      // the light's azimuth is half a turn from the file's, which must fall on a cell again
      if (cells != std::floor(cells) || (cells > 1 && std::fmod(cells, 2) != 0))
        throw error(count, "the number of cells of a ring must be 1 or even");
      basis.theta.push_back(high);
      basis.cells.push_back(static_cast<int>(cells));
      if (basis.cells.size() > kMostRings || basis.size() > kMostBasis)
        throw error(node, fmt::format("an angle basis of more than {} rings or {} cells",
                                      kMostRings, kMostBasis));
    }
    if (basis.cells.empty() || std::abs(basis.theta.back() - kPi / 2) > 1e-6)
      throw error(node, "an angle basis must reach 90 degrees");
    basis.theta.back() = kPi / 2;
    return basis;
  }

  KlemsBasis find_basis(pugi::xml_node definition, pugi::xml_node block, const char* element) {
    pugi::xml_node wanted = need(block, element);
    std::string name = trimmed(wanted.child_value());
    for (pugi::xml_node basis : definition.children("AngleBasis"))
      if (lower(trimmed(basis.child_value("AngleBasisName"))) == lower(name))
        return read_basis(basis);
    auto known = klems_bases().find(lower(name));
    if (known == klems_bases().end())
      throw error(wanted, fmt::format("unknown angle basis '{}'", name),
                  "LBNL/Klems Full, Half or Quarter, or one that <AngleBasis> defines");
    return known->second;
  }

  /// The light's cell of every one of the file: half a turn on in its ring.
  static std::vector<size_t> turned_cells(const KlemsBasis& basis) {
    std::vector<size_t> out;
    for (int cells : basis.cells) {
      size_t first = out.size();
      for (int j = 0; j < cells; ++j)
        out.push_back(first + static_cast<size_t>((j + cells / 2) % cells));
    }
    return out;
  }

  /// [incident][outgoing] of a block.
  std::vector<double> read_matrix(const Block& block, const MeasuredPatches& patches, bool rows) {
    ScatteringText text = scattering_text(block.node);
    TextScanner scanner(text.text, 0);
    size_t in = static_cast<size_t>(patches.incident.size());
    size_t out = static_cast<size_t>(patches.outgoing.size());
    std::vector<size_t> turned = turned_cells(patches.incident);
    std::vector<double> matrix(in * out);
    for (size_t k = 0; k < in * out; ++k) {
      if (scanner.at_end())
        throw text.error(scanner.position(), fmt::format("{} values, not {} x {}", k, in, out));
      const char* at = scanner.position();
      double value = 0;
      try {
        value = scanner.number("a value");
      } catch (const Error& e) {
        throw text.error(at, e.message());
      }
      size_t i = rows ? k / out : k % in, o = rows ? k % out : k / in;
      matrix[turned[i] * out + o] = value;
    }
    if (!scanner.at_end())
      throw text.error(scanner.position(), fmt::format("more than {} x {} values", in, out));
    return matrix;
  }

  MeasuredFile read_klems(MeasuredInfo info, pugi::xml_node definition, bool rows) {
    MeasuredPatches patches;
    patches.incident = find_basis(definition, blocks_[0].node, "ColumnAngleBasis");
    patches.outgoing = find_basis(definition, blocks_[0].node, "RowAngleBasis");
    for (const Block& block : blocks_)
      for (bool column : {true, false}) {
        KlemsBasis other =
            find_basis(definition, block.node, column ? "ColumnAngleBasis" : "RowAngleBasis");
        const KlemsBasis& first = column ? patches.incident : patches.outgoing;
        if (other.theta != first.theta || other.cells != first.cells)
          throw error(block.node, "all blocks must have the same angle bases");
      }
    for (int p = 0; p < 4; ++p) {
      auto pass = static_cast<MeasuredPass>(p);
      const Block* blocks[3] = {find(pass, kX), find(pass, kY), find(pass, kZ)};
      if (blocks[1] == nullptr)
        continue;
      bool color = blocks[0] != nullptr && blocks[2] != nullptr;
      std::vector<double> channels[3];
      for (int c = 0; c < 3; ++c)
        if (color || c == 1)
          channels[c] = read_matrix(*blocks[c], patches, rows);
      patches.rgb[pass].resize(3 * channels[1].size());
      for (size_t k = 0; k < channels[1].size(); ++k) {
        double values[3] = {0, channels[1][k], 0};
        if (color) {
          values[0] = channels[0][k];
          values[2] = channels[2][k];
        }
        store(&patches.rgb[pass][3 * k],
              color ? xyz_to_srgb({values[0], values[1], values[2]})
                    : std::array{values[1], values[1], values[1]},
              info);
      }
      info.cells += static_cast<int64_t>(channels[1].size());
    }
    if (patches.incident.theta == patches.outgoing.theta &&
        patches.incident.cells == patches.outgoing.cells)
      complete_transmission(patches.rgb, info, [&](std::vector<float>& rgb) {
        size_t n = static_cast<size_t>(patches.incident.size());
        for (size_t i = 0; i < n; ++i)
          for (size_t o = 0; o < i; ++o)
            std::swap_ranges(&rgb[3 * (i * n + o)], &rgb[3 * (i * n + o)] + 3,
                             &rgb[3 * (o * n + i)]);
      });
    info.resolution = fmt::format("{} x {} cells (light, viewer)", patches.incident.size(),
                                  patches.outgoing.size());
    info.interpolation = "constant within a pair of cells";
    finish(info);
    return {std::move(info), std::move(patches)};
  }

  static void store(float* out, const std::array<double, 3>& rgb, MeasuredInfo& info) {
    bool negative = false;
    for (int c = 0; c < 3; ++c) {
      negative |= rgb[c] < 0;
      out[c] = static_cast<float>(std::clamp(rgb[c], 0.0, 1e30));
    }
    info.negative += negative;
  }

  /// Transmission that the file gives for one side only holds for the other as well (Helmholtz).
  template <class Data, class Transpose> static void
  complete_transmission(std::array<Data, 4>& data, MeasuredInfo& info, Transpose transpose_data) {
    bool front = !data[kFrontTransmission].empty(), back = !data[kBackTransmission].empty();
    if (front == back)
      return;
    Data& missing = data[front ? kBackTransmission : kFrontTransmission];
    missing = data[front ? kFrontTransmission : kBackTransmission];
    transpose_data(missing);
    info.notes.push_back("transmission is given for one side; the other by reciprocity");
  }

  void finish(MeasuredInfo& info) const {
    info.symmetries.push_back("anisotropic");
    info.notes.push_back("'Front' in the file is the side of negative z");
    info.largest_theta = kPi / 2;
    if (info.negative > 0)
      info.notes.push_back(fmt::format("{} values or colours below zero: 0", info.negative));
  }

  // -- tensor trees -----------------------------------------------------------------------------

  ChannelTree read_channel(const Block& block, int dimensions, MeasuredInfo& info) {
    pugi::xml_node basis = need(block.node, "AngleBasis");
    if (lower(trimmed(basis.child_value())) != "lbnl/shirley-chiu")
      throw error(basis, "a tensor tree must have the angle basis LBNL/Shirley-Chiu");
    ChannelTree tree = parse_tensor_tree(scattering_text(block.node), dimensions);
    if (dimensions == 4)
      flip_light(tree);
    if (block.channel == kY) {
      info.negative += tree.negative;
      info.cells += static_cast<int64_t>(tree.values.size());
    }
    return tree;
  }

  MeasuredFile read_tree(MeasuredInfo info, int dimensions) {
    MeasuredTree tree;
    tree.dimensions = dimensions;
    for (int p = 0; p < 4; ++p) {
      auto pass = static_cast<MeasuredPass>(p);
      if (find(pass, kY) == nullptr)
        continue;
      bool xyz = find(pass, kX) != nullptr && find(pass, kZ) != nullptr;
      bool uv = !xyz && find(pass, kU) != nullptr && find(pass, kV) != nullptr;
      ChannelTree y = read_channel(*find(pass, kY), dimensions, info), first, last;
      if (xyz || uv) {
        first = read_channel(*find(pass, xyz ? kX : kU), dimensions, info);
        last = read_channel(*find(pass, xyz ? kZ : kV), dimensions, info);
      }
      bool color = xyz || uv;
      merge_trees(
          {color ? &first : &y, &y, color ? &last : &y}, dimensions,
          [&](const double* v) { return tree_color(v, xyz, uv); }, tree.nodes[pass],
          tree.rgb[pass]);
      for (const ChannelTree* channel : {&y, &first, &last})
        tree.depth = std::max(tree.depth, channel->depth);
    }
    bool one_side = tree.nodes[kFrontTransmission].empty() != tree.nodes[kBackTransmission].empty();
    if (one_side && dimensions == 4) {
      MeasuredInfo ignored;
      complete_transmission(tree.nodes, info, [](std::vector<int32_t>& n) { transpose(n); });
      complete_transmission(tree.rgb, ignored, [](std::vector<float>&) {});
    } else if (one_side) {
      info.notes.push_back("transmission is given for one side only; none from the other");
    }
    info.resolution = fmt::format("{} leaves, {} levels ({})", info.cells, tree.depth,
                                  dimensions == 4 ? "light and viewer" : "polar angle and viewer");
    info.interpolation = "constant within a cell of the tree";
    finish(info);
    if (dimensions == 3)
      info.symmetries = {"isotropic"};
    return {std::move(info), std::move(tree)};
  }

  /// Linear sRGB of (Y, Y, Y), of (X, Y, Z) or of (u', Y, v') of CIE 1976.
  static std::array<double, 3> tree_color(const double* v, bool xyz, bool uv) {
    if (!xyz && !uv)
      return {v[1], v[1], v[1]};
    double x = v[0], z = v[2];
    if (uv) {
      double scale = v[2] > 1e-6 ? v[1] / (4 * v[2]) : 0;
      x = 9 * v[0] * scale;
      z = (12 - 3 * v[0] - 20 * v[2]) * scale;
    }
    std::array<double, 3> rgb = xyz_to_srgb({x, v[1], z});
    for (double& c : rgb)
      c = std::clamp(c, 0.0, 1e30);
    return rgb;
  }

  const InputText& input_;
  xml::Source source_;
  std::vector<Block> blocks_;
};

bool is_window_xml(std::string_view bytes) {
  return bytes.substr(0, 4096).find("<WindowElement") != bytes.npos;
}

} // namespace

bool is_tensor_tree(std::string_view bytes) {
  return is_window_xml(bytes) && bytes.substr(0, size_t(1) << 16).find("TensorTree") != bytes.npos;
}

bool is_klems(std::string_view bytes) {
  return is_window_xml(bytes) && !is_tensor_tree(bytes);
}

MeasuredFile read_window_xml(const InputText& input, const MeasuredOptions& options) {
  return WindowReader(input, options).read();
}

} // namespace faceta
