#pragma once
/// Pictures of water of known shape: how far the drawn outline and normals are from the closed form.

#include <limits>
#include <string>
#include <vector>

#include "libsim/gl/png.hpp"
#include "libsim/render/fluid_renderer.hpp"

namespace measure {

enum class KnownShape {
  Pool,    ///< a plane between walls, seen from above at a slant
  Ball,    ///< seen from afar, like the next two
  Column,  ///< a vertical cylinder
  Sheet    ///< a slab as thick as three coarsest particles, seen on edge
};
inline constexpr KnownShape known_shapes[] = {KnownShape::Pool, KnownShape::Ball, KnownShape::Column,
                                              KnownShape::Sheet};
std::string shape_name(KnownShape shape);

/// Water of one level, 0 .. 3, or mixed_levels: four slabs side by side, of the levels 0 to 3.
inline constexpr int mixed_levels = 4;

/// Errors of a picture; NaN where the shape has no such figure.
struct ShapeErrors {
  /// RMS distance of the outline from the closed form, in spacings d of the particles; of the pool: RMS
  /// height
  double outline_d = std::numeric_limits<double>::quiet_NaN();
  /// RMS angle between the drawn and the true normals; of the ball and the column within 80 % of the radius
  double normals_deg = std::numeric_limits<double>::quiet_NaN();
  /// mean square of the outline's curvature times d, over wavelengths from 2/3 d to 3/2 d
  double scallop = std::numeric_limits<double>::quiet_NaN();
};

struct ShapePicture {
  ShapeErrors errors;
  sim::Image image;
};

/// Draws a shape of the volume of n_star coarsest particles: lattices with the solver's spacing, each
/// particle moved at random by up to a tenth of it. The same arguments give the same particles for both
/// surfaces. A spacing is 16 px wide. Needs a current context.
ShapePicture draw_shape(KnownShape shape, int level, std::int64_t n_star, sim::Surface surface);

/// The mean square of the second derivative of `away`, samples `step` apart, times d, over wavelengths from
/// 2/3 d to 3/2 d. away, step and d in one unit.
double curvature_energy(const std::vector<double>& away, double step, double d);

}  // namespace measure
