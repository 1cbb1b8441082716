#pragma once

/// Tables made of Faceta's own models, under names that begin with "demo:": what tests, the gallery
/// and first steps use where no measured file is at hand.

#include "bsdf/measured_data.h"
#include "bsdf/registry.h"
#include "bsdf/rgl_tables.h"

namespace faceta {

/// Loads them for materials that name them; other names are an Error. What Registry::global()
/// begins with, see set_file_loader().
std::shared_ptr<const FileTables> load_demo(const Parameters& parameters,
                                            const SourcePosition& where);

bool is_demo(const std::string& name);
/// "demo:plastic", ...
std::vector<std::string> demo_names();
/// Error with a suggestion if there is none of that name.
MeasuredFile measured_demo(const std::string& name);

/// f_r at all nodes of a grid whose coordinates and axes are given. Nodes that belong to directions
/// below the surface become holes.
void tabulate(const Reflectance& f, MeasuredGrid& grid);

/// The directions that coordinates stand for; false if one of them is below the surface.
bool directions_of(MeasuredCoordinates coordinates, const double* angles, Vec3<double>& wo,
                   Vec3<double>& wi);

} // namespace faceta
