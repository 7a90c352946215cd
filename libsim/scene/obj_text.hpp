#pragma once
/// Meshes as text: Wavefront OBJ.

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sim {

/// A closed surface. Each triangle is counter-clockwise as seen from outside.
struct Triangles {
  std::vector<std::array<double, 3>> places;
  std::vector<std::array<int, 3>> faces;
};

/// Largest number of triangles of a mesh. A scene's 1 MiB of text (most_scene_bytes) has space for this
/// number if coordinates have few digits, and for fewer triangles if they have seven digits.
inline constexpr std::size_t most_triangles = 1 << 15;

/// Throws an error for a line of the text; line 0: the whole text.
using ObjFailure = std::function<void(int line, const std::string& problem, const std::string& mend)>;

/// Reads lines `v x y z` and `f a b c ...`; f may name texture and normal after a slash, and count vertices
/// back from the last one by negative numbers. Polygons become fans. Other lines are skipped, and vertices
/// that no face uses are dropped. Failures: a malformed or missing number, a coordinate beyond 1e6, an
/// unknown vertex, a face without area or with fewer than three corners, no face, more than most_triangles,
/// an edge that is not shared by two faces in opposite directions, a surface that faces inwards.
Triangles read_obj(std::string_view text, const ObjFailure& fail);

/// The surface `mesh` as compact OBJ text: only vertices and triangles, one per line.
std::string obj_of(const Triangles& mesh);

/// Volume enclosed by the surface; negative if it faces inwards.
double enclosed_volume(const Triangles& mesh);

}  // namespace sim
