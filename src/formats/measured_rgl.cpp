#include "formats/measured_rgl.h"

#include "formats/byte_cursor.h"
#include "formats/measured_common.h"
#include "formats/measured_readers.h"
#include "formats/measured_tensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

class RglReader {
public:
  RglReader(const InputText& input, const MeasuredOptions& options)
      : input_(input), options_(options), file_(input) {}

  MeasuredFile run() {
    expect_one_material(input_, options_);
    read_nodes();
    read_densities();
    if (file_.find("rgb"))
      read_colours();
    else
      read_spectra();
    describe();
    return {std::move(info_), std::move(tables_)};
  }

private:
  // The angles of the viewer at which there are tables.
  void read_nodes() {
    tables_.phi_i = increasing("phi_i");
    tables_.theta_i = increasing("theta_i");
    phis_ = tables_.phi_i.size(), thetas_ = tables_.theta_i.size();
    const float last = tables_.theta_i.back();
    if (tables_.theta_i.front() < 0 || last > 90.001 * kDegree)
      throw file_.error(file_.find("theta_i"), "'theta_i' must lie between 0 and pi/2");
    tables_.jacobian = file_.require("jacobian", TensorType::u8, {1}).bytes[0] != 0;
  }

  std::vector<float> increasing(const char* name) {
    const TensorField& field = file_.require(name, TensorType::f32, {0});
    std::vector<float> values = file_.finite_floats(field);
    for (size_t i = 1; i < values.size(); ++i)
      if (!(values[i] > values[i - 1]))
        throw file_.error(&field, fmt::format("'{}' must increase strictly, value {} does not "
                                              "follow",
                                              name, i + 1));
    return values;
  }

  void read_densities() {
    tables_.ndf = density("ndf", {0, 0}, tables_.ndf_size);
    tables_.sigma = density("sigma", {0, 0}, tables_.sigma_size);
    tables_.vndf = density("vndf", {phis_, thetas_, 0, 0}, tables_.vndf_size);
    tables_.luminance = density("luminance", {phis_, thetas_, 0, 0}, tables_.luminance_size);
    texels_ = bounded_product({static_cast<uint64_t>(tables_.luminance_size[0]),
                               static_cast<uint64_t>(tables_.luminance_size[1])},
                              input_.text.size());
  }

  // A table of what cannot be negative. Its last two axes are rows and columns of nodes, between
  // which there must be something to interpolate.
  std::vector<float> density(const char* name, const std::vector<uint64_t>& shape, int (&size)[2]) {
    const TensorField& field = file_.require(name, TensorType::f32, shape);
    for (size_t axis = 0; axis < 2; ++axis) {
      uint64_t nodes = field.shape[shape.size() - 2 + axis];
      if (nodes < 2 || nodes > kMaxNodes)
        throw file_.error(&field, fmt::format("'{}' has {} rows or columns, 2 to {} make sense",
                                              name, nodes, kMaxNodes));
      size[axis] = static_cast<int>(nodes);
    }
    std::vector<float> values = file_.finite_floats(field);
    int64_t mended = 0;
    for (float& value : values)
      if (value < 0) {
        value = 0;
        ++mended;
      }
    if (mended > 0)
      info_.notes.push_back(fmt::format("{} negative values of '{}': 0", mended, name));
    return values;
  }

  // A field whose texels are those of the luminance, with a third axis before rows and columns.
  const TensorField& layers(const char* name, uint64_t count) {
    return file_.require(name, TensorType::f32,
                         {phis_, thetas_, count, static_cast<uint64_t>(tables_.luminance_size[0]),
                          static_cast<uint64_t>(tables_.luminance_size[1])});
  }

  void read_colours() {
    expect_one_coloured_material(input_, options_);
    mix_layers(layers("rgb", 3), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  }

  void read_spectra() {
    std::vector<float> wavelengths = increasing("wavelengths");
    info_.wavelengths.assign(wavelengths.begin(), wavelengths.end());
    if (!(wavelengths.front() > 0))
      throw file_.error(file_.find("wavelengths"), "wavelengths must be positive");
    const TensorField& spectra = layers("spectra", wavelengths.size());
    mix_layers(spectra, wavelength_weights(info_.wavelengths, options_.wavelength, {input_.name}));
    if (options_.wavelength >= 0)
      info_.notes.push_back(fmt::format("only {} nm, as grey", options_.wavelength));
    else
      info_.notes.push_back("spectra became linear sRGB under D65");
  }

  // Adds the layers of each table up by their weights, texel by texel.
  void mix_layers(const TensorField& field, const WavelengthWeights& weights) {
    const size_t tables = phis_ * thetas_;
    std::vector<float> values = file_.finite_floats(field);
    tables_.rgb.resize(tables * texels_ * 3);
    std::vector<double> sum(texels_ * 3);
    for (size_t table = 0; table < tables; ++table) {
      std::fill(sum.begin(), sum.end(), 0);
      for (size_t layer = 0; layer < weights.size(); ++layer) {
        const float* texel = &values[(table * weights.size() + layer) * texels_];
        const auto [r, g, b] = weights[layer];
        for (size_t i = 0; i < texels_; ++i) {
          sum[3 * i] += r * texel[i];
          sum[3 * i + 1] += g * texel[i];
          sum[3 * i + 2] += b * texel[i];
        }
      }
      for (size_t i = 0; i < sum.size(); ++i) {
        tables_.rgb[table * sum.size() + i] = static_cast<float>(sum[i]);
        info_.negative += sum[i] < 0;
      }
    }
    check_range(field);
  }

  // Values near the largest float add up to infinity.
  void check_range(const TensorField& field) {
    if (!std::all_of(tables_.rgb.begin(), tables_.rgb.end(),
                     [](float v) { return std::isfinite(v); }))
      throw file_.error(&field, "the values of '" + field.name + "' are too large");
  }

  void describe() {
    const bool isotropic = phis_ <= 2;
    if (const TensorField* text = file_.find("description"))
      info_.description = shown_text(text->bytes);
    info_.resolution =
        fmt::format("{} x {} (phi_i, theta_i) tables of {} x {} texels; {} x {} visible normals",
                    phis_, thetas_, tables_.luminance_size[0], tables_.luminance_size[1],
                    tables_.vndf_size[0], tables_.vndf_size[1]);
    info_.interpolation = "linear in the warped square of visible normals, and between the angles "
                          "of the viewer before the warp is inverted";
    info_.symmetries.push_back(isotropic ? "isotropic" : "anisotropic");
    info_.cells = static_cast<int64_t>(phis_ * thetas_ * texels_);
    info_.largest_theta = tables_.theta_i.back();
  }

  static constexpr uint64_t kMaxNodes = 1 << 16;
  const InputText& input_;
  const MeasuredOptions& options_;
  TensorFile file_;
  MeasuredInfo info_;
  RglTables tables_;
  size_t phis_ = 0, thetas_ = 0, texels_ = 0;
};

template <class T> TensorField field_of(const char* name, TensorType type,
                                        std::vector<uint64_t> shape, const std::vector<T>& values) {
  return {name,
          type,
          std::move(shape),
          {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)}};
}

void check_sizes(const std::string& path, const RglTables& t) {
  auto fits = [](const std::vector<float>& values, size_t tables, const int(&size)[2], int depth) {
    return size[0] >= 2 && size[1] >= 2 &&
           values.size() == tables * static_cast<size_t>(size[0]) * static_cast<size_t>(size[1]) *
                                static_cast<size_t>(depth);
  };
  const size_t tables = t.phi_i.size() * t.theta_i.size();
  if (tables == 0 || !fits(t.ndf, 1, t.ndf_size, 1) || !fits(t.sigma, 1, t.sigma_size, 1) ||
      !fits(t.vndf, tables, t.vndf_size, 1) || !fits(t.luminance, tables, t.luminance_size, 1) ||
      !fits(t.rgb, tables, t.luminance_size, 3))
    throw Error("cannot write: the sizes of the tables do not fit together", {path});
}

} // namespace

bool is_rgl(std::string_view bytes) {
  return is_tensor_file(bytes) && !is_pbsdf(bytes);
}

MeasuredFile read_rgl(const InputText& input, const MeasuredOptions& options) {
  return RglReader(input, options).run();
}

void write_rgl(const std::string& path, const RglTables& t, const std::string& description) {
  check_sizes(path, t);
  auto size = [](int n) { return static_cast<uint64_t>(n); };
  const uint64_t phis = t.phi_i.size(), thetas = t.theta_i.size();
  const uint64_t rows = size(t.luminance_size[0]), columns = size(t.luminance_size[1]);
  const uint64_t texels = rows * columns;
  std::vector<float> planes(t.rgb.size());
  for (size_t table = 0; table < phis * thetas; ++table)
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < texels; ++i)
        planes[(table * 3 + c) * texels + i] = t.rgb[(table * texels + i) * 3 + c];

  // The official files hold these fields in this order. Of "valid" (which texels were measured, a
  // bit for each theta_i) no reader makes use.
  const std::vector<uint32_t> version = {1, 0};
  const std::vector<char> text(description.begin(), description.end());
  const std::vector<uint8_t> jacobian = {t.jacobian}, valid(texels, 255);
  using enum TensorType;
  write_tensor_file(
      path,
      {field_of("version", u32, {2}, version), field_of("description", u8, {text.size()}, text),
       field_of("phi_i", f32, {phis}, t.phi_i), field_of("theta_i", f32, {thetas}, t.theta_i),
       field_of("sigma", f32, {size(t.sigma_size[0]), size(t.sigma_size[1])}, t.sigma),
       field_of("ndf", f32, {size(t.ndf_size[0]), size(t.ndf_size[1])}, t.ndf),
       field_of("vndf", f32, {phis, thetas, size(t.vndf_size[0]), size(t.vndf_size[1])}, t.vndf),
       field_of("luminance", f32, {phis, thetas, rows, columns}, t.luminance),
       field_of("rgb", f32, {phis, thetas, 3, rows, columns}, planes),
       field_of("jacobian", u8, {1}, jacobian), field_of("valid", u8, {texels}, valid)});
}

} // namespace faceta
