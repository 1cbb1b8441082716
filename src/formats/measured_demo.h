#pragma once

/// Tables made of Faceta's own models, under names that begin with "demo:": what tests, the gallery
/// and first steps use where no measured file is at hand.

#include "bsdf/measured_data.h"
#include "bsdf/registry.h"

namespace faceta {

bool is_demo(const std::string& name);
/// "demo:plastic", ...
std::vector<std::string> demo_names();
/// Error with a suggestion if there is none of that name.
MeasuredFile measured_demo(const std::string& name, const MeasuredOptions& options = {});

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

/// The values of a material at all nodes of a grid whose coordinates and axes are given: f_r of
/// what it reflects from the front, without delta lobes. Nodes that belong to directions below the
/// surface become holes.
void tabulate(const Parameters& material, MeasuredGrid& grid);

/// The directions that coordinates stand for; false if one of them is below the surface.
bool directions_of(MeasuredCoordinates coordinates, const double* angles, Vec3<double>& wo,
                   Vec3<double>& wi);

} // namespace faceta
