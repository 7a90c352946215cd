#pragma once
/// Meshes as text: Wavefront OBJ.

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sim {

/// A closed surface. Each triangle runs against the clock as seen from outside.
struct Triangles {
  std::vector<std::array<double, 3>> places;
  std::vector<std::array<int, 3>> faces;
};

/// What a scene's 1 MiB of text (most_scene_bytes) holds in places of few digits; in places of seven it holds
/// fewer.
inline constexpr std::size_t most_triangles = 1 << 15;

/// Throws what a line of the text does wrong; line 0: all of it.
using ObjFailure = std::function<void(int line, const std::string& problem, const std::string& mend)>;

/// Lines `v x y z` and `f a b c ...`, of which f may name texture and normal behind a slash and count places
/// back from the last one by negative numbers. Polygons become fans. Other lines are skipped, and places that
/// no face names are left out. Failures: a number that is none, a place that is not there, a face without
/// area, no face, too many, an edge that two faces do not meet in opposite directions, a surface that looks
/// inwards.
Triangles read_obj(std::string_view text, const ObjFailure& fail);

/// The same surface in few bytes: places and triangles alone, each on a line.
std::string obj_of(const Triangles& mesh);

/// Of what the surface encloses; negative when it looks inwards.
double enclosed_volume(const Triangles& mesh);

}  // namespace sim
