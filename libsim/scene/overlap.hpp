#pragma once
/// Obstacles that begin inside each other.

#include "libsim/scene/obstacle.hpp"

namespace sim {

/// How deep the one lies in the other where they begin, m; <= 0: apart. Looked at along the edges of the
/// boxes round which shapes lie and at the places of meshes, so that a mesh whose places are far apart may
/// hide some.
double overlap_m(const Obstacle& one, const Obstacle& other);

/// Touching is no overlap, and neither is what numbers of a file round to.
inline constexpr double least_overlap_m = 1e-5;

}  // namespace sim
