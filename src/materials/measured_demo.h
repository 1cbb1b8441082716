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

/// The model that renders what a file holds: `measured`, or `measuredwindow` for what transmits or
/// is constant over cells.
const char* model_of(const MeasuredFile& file);
/// Error that names the right model if it is not this one.
void check_model(const MeasuredFile& file, const std::string& name, const std::string& model);

/// Whether it is one of those that transmit, for the model `measuredwindow`.
bool is_cell_demo(const std::string& name);

/// What demonstrations that transmit are made of, f_r: diffuse light and a lobe about the mirror
/// direction or straight on, another for each pass. wi and wo on the sides that the pass says.
std::array<double, 3> demo_window(MeasuredPass pass, const Vec3<double>& wi,
                                  const Vec3<double>& wo);
/// demo:shade: demo_window() in the middle of the 145 x 145 cells of Klems's full basis.
MeasuredPatches demo_patches();
/// demo:tree3, demo:tree4: the same as a tensor tree.
MeasuredTree demo_tree(int dimensions);

/// The directions that coordinates stand for; false if one of them is below the surface.
bool directions_of(MeasuredCoordinates coordinates, const double* angles, Vec3<double>& wo,
                   Vec3<double>& wi);

} // namespace faceta
