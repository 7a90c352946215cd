#pragma once
/// Reads meshes of a scene's obstacles, from an OBJ file or from text in the scene file.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "libsim/scene/mesh.hpp"
#include "stats/base/toml.hpp"

namespace sim {

/// Reads the keys `file` or `obj`, `scale` and `spacing_m` of an obstacle. Errors are base::Error at the key,
/// or at file:line. size_m: allowed range of the mesh's sides, m. beside: the folder to which `file` is
/// relative; without one, a `file` is an error.
std::shared_ptr<const Mesh> read_mesh(const base::TomlTable& table, base::Range size_m,
                                      const std::optional<std::filesystem::path>& beside);

/// The scene's text with each mesh `file` replaced by its triangles as `obj`, so that the text is
/// self-contained; unchanged if no obstacle has such a file. Errors are base::Error: at the mesh's file if it
/// cannot be read or the text would exceed most_scene_bytes, at the scene's for a `file` that is not on a
/// line of its own.
std::string with_meshes(std::string_view text, const std::filesystem::path& scene_file);
inline constexpr std::size_t most_scene_bytes = 1 << 20;

}  // namespace sim
