#pragma once

/// Files of measured reflectance of any format, told apart by their content.

#include "bsdf/measured_data.h"
#include "formats/input_text.h"

namespace faceta {

/// One format. recognises() looks at the first bytes only and says yes to damaged files too, so
/// that read() can say what is wrong with them.
struct MeasuredFormat {
  const char* name;  ///< as in MeasuredInfo::format
  const char* title; ///< as in MeasuredInfo::title
  bool (*recognises)(std::string_view bytes);
  MeasuredFile (*read)(const InputText& input, const MeasuredOptions& options);
};

/// All of them, in the order in which they are tried.
const std::vector<MeasuredFormat>& measured_formats();

/// Reads the bytes of a file; `name` is for messages. Error with the file, and where in it, if no
/// format recognises it, if it is not of the format that the options want, or if it is damaged.
MeasuredFile parse_measured(std::string_view bytes, const std::string& name,
                            const MeasuredOptions& options = {});

/// The same for a file on disk, which is mapped into memory, not copied.
MeasuredFile read_measured(const std::string& path, const MeasuredOptions& options = {});

/// The short name of the format that recognises a file; empty if none does or it cannot be opened.
std::string format_of_measured(const std::string& path);

} // namespace faceta
