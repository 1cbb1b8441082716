#pragma once

/// What the readers of measured reflectance in text have in common: words and numbers with their
/// places, what the values of a row mean, and rows that become a grid.

#include "bsdf/measured_data.h"
#include "formats/input_text.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace faceta {

/// Walks over the words of a text. White space and commas separate them; `comment` (if not 0)
/// starts a comment that reaches to the end of the line.
class TextScanner {
public:
  explicit TextScanner(const InputText& input, char comment = '#')
      : input_(input), at_(input.text.data()), end_(at_ + input.text.size()), last_(at_),
        comment_(comment) {}

  /// Skips what separates words; true if nothing is left.
  bool at_end();
  /// The same within the current line.
  bool at_line_end();
  /// Passes the end of the current line, and comment and empty lines behind it.
  void next_line();
  /// The next word, empty at the end.
  std::string_view word();
  /// The next word, without taking it.
  std::string_view peek();
  /// A finite number; Error that names `what` if the next word is none.
  double number(const char* what);
  /// An integer from `least` to `most`; Error otherwise.
  int64_t integer(const char* what, int64_t least, int64_t most);

  /// Where the last word began.
  const char* last() const { return last_; }
  const char* position() const { return at_; }
  void move_to(const char* position) { at_ = position; }
  /// Bytes that are left: no declared count of numbers may be above half of them.
  int64_t bytes_left() const { return end_ - at_; }

  Error error(const std::string& message, const std::string& hint = {}) const {
    return input_.error(last_, message, hint);
  }

private:
  void skip(bool over_lines);

  const InputText& input_;
  const char *at_, *end_, *last_;
  char comment_;
};

/// True if `bytes` has no byte that text has not, in its first 4096.
bool looks_like_text(std::string_view bytes);
/// True if one of the first lines (within 64 KiB) starts with `word`, as a word of its own.
bool has_line_with(std::string_view bytes, std::string_view word);

/// What the numbers behind the angles of a row are.
struct MeasuredColumns {
  enum Kind { kGrey, kRgb, kXyz, kSpectral };
  Kind kind = kGrey;
  std::vector<double> wavelengths{}; ///< nm, increasing strictly; kSpectral only
};

/// Turns the numbers of a row into linear sRGB: XYZ by xyz_to_srgb; spectra by
/// wavelength_weights(). What is below zero becomes 0.
class MeasuredColors {
public:
  /// Error at `where` if the wavelengths do not increase, do not fit the option, or if it asks for
  /// one where there are none.
  MeasuredColors(const MeasuredColumns& columns, const MeasuredOptions& options,
                 const InputText& input, const char* where);

  int count() const { return static_cast<int>(weights_.size()); }
  /// The colour of a row of count() numbers. A row with a component below zero, before or after,
  /// counts in `negative` once.
  std::array<double, 3> rgb(const double* values, int64_t& negative) const;

private:
  std::vector<std::array<double, 3>> weights_; ///< the colour is their sum times the values
};

/// A direction as files give it: a polar angle from -pi/2 to pi/2 (negative: on the other side of
/// the normal, azimuth + pi) becomes one from 0. Error at `where` if it is outside by more than
/// rounding.
void fold_polar_angle(double& theta, double& phi, const InputText& input, const char* where,
                      const char* name);

/// Rows that a reader collected become a grid of their own angles if they lie on one, else the grid
/// of grid_from_samples(); what was done is told in `info` (resolution, interpolation, symmetries,
/// notes, cells, holes, largest_theta). Error if there is no row.
MeasuredFile file_from_samples(MeasuredInfo info, std::vector<MeasuredSample> samples,
                               bool isotropic, const InputText& input);

} // namespace faceta
