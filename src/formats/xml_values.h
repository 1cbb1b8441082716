#pragma once

#include "formats/xml_tree.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Numbers and lists of numbers as Mitsuba scene files write them.
namespace faceta::xml {

/// A decimal number, nothing but white space around it; also inf, infinity and nan in any case.
/// Too large is infinite, too small is zero. Empty if it is anything else.
std::optional<double> parse_number(std::string_view text);
/// A decimal integer that fits 64 bits, nothing but white space around it, no plus sign.
std::optional<int64_t> parse_integer(std::string_view text);
/// "true" or "false" in any case.
std::optional<bool> parse_boolean(std::string_view text);

/// Pieces between commas and spaces; empty pieces are skipped.
std::vector<std::string_view> split_list(std::string_view text);
/// All pieces as numbers. @throws Error at `where` that quotes the first piece that is none.
std::vector<double> parse_numbers(std::string_view text, const SourcePosition& where);

/// "0.5" or "400:0.1, 700:0.2".
SpectrumValue parse_spectrum(std::string_view text, const SourcePosition& where);
/// Lines of `wavelength value`; `#` begins a comment. Further columns are ignored, with a warning.
SpectrumValue read_spectrum_file(const std::filesystem::path& path, const SourcePosition& where,
                                 const Warn& warn);

Matrix4 multiply(const Matrix4& a, const Matrix4& b);
Matrix4 translation(const Numbers3& offset);
Matrix4 scaling(const Numbers3& factors);
/// Rodrigues' rotation. As in Mitsuba the axis is used as it is: if it has not length 1 the result
/// is no rotation.
Matrix4 rotation(const Numbers3& axis, double degrees);
/// Columns left, up, direction, origin. Without `up` (or with a zero one) some perpendicular is
/// taken: Duff et al. 2017. Empty if the three do not span a frame.
std::optional<Matrix4> look_at(const Numbers3& origin, const Numbers3& target, Numbers3 up);

} // namespace faceta::xml
