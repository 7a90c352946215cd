#pragma once
/// Meshes of a scene's obstacles: a file beside the scene's, or lines of text in it.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "libsim/scene/mesh.hpp"
#include "stats/base/toml.hpp"

namespace sim {

/// The keys `file` or `obj`, `scale` and `spacing_m` of an obstacle. Errors are base::Error at the key, or at
/// file:line. size: of the mesh's sides, m. beside: the folder that `file` counts from; without one, a `file`
/// is an error.
std::shared_ptr<const Mesh> read_mesh(const base::TomlTable& table, base::Range size_m,
                                      const std::optional<std::filesystem::path>& beside);

/// The scene's text with each `file` of a mesh replaced by its triangles as `obj`, so that it stands alone;
/// where no obstacle has such a file the text as it is. Errors are base::Error: at the mesh's file when it
/// takes the text beyond most_scene_bytes, at the scene's for a `file` that does not stand on a line of its
/// own.
std::string with_meshes(std::string_view text, const std::filesystem::path& scene_file);
inline constexpr std::size_t most_scene_bytes = 1 << 20;

}  // namespace sim
