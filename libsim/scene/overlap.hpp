#pragma once
/// Obstacles that overlap at the start.

#include "libsim/scene/obstacle.hpp"

namespace sim {

/// Depth of the overlap at the start, m; <= 0: separate. Tested along the edges of the shapes' inner boxes
/// (half_sides_m() in obstacle.hpp) and at the vertices of meshes, so that overlaps between distant vertices
/// of a mesh may be missed.
double overlap_m(const Obstacle& one, const Obstacle& other);

/// Overlaps up to this depth, m, are no errors: they come from contact or from rounding of the file's
/// numbers.
inline constexpr double least_overlap_m = 1e-5;

}  // namespace sim
