#pragma once

/// Tables that a material has from a file: one block of numbers in memory, however many materials
/// use it.

#include "base/error.h"
#include "base/huge_vector.h"

#include <memory>
#include <string>

namespace faceta {

class Parameters;

/// What a file became. `values` has kLanePadding numbers more than its layout needs; its meaning is
/// the model's business (measured_table.h).
struct FileTables {
  std::string name; ///< as the parameters give it
  HugeVector<float> values;
};

/// Loads the file that parameters name; Error at `where` if it cannot. The same file with the same
/// settings gives the same block while one is in use.
using FileLoader = std::shared_ptr<const FileTables> (*)(const Parameters& parameters,
                                                         const SourcePosition& where);

/// Says how files are loaded: the room formats/ knows (measured_loader.h). Until then materials with
/// files are an Error.
void set_file_loader(FileLoader loader);

} // namespace faceta
