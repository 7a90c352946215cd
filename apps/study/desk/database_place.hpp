#pragma once
/// Whether a database lies where it can be kept: not on a network file system, and not in a folder that a
/// service copies to other computers.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What is asked of the system.
struct PlaceProbe {
  /// Number of the file system's kind (statfs, f_type) of a folder; none: not known.
  std::function<std::optional<std::uint32_t>(const std::filesystem::path&)> file_system;
  /// Kind of the mount that a folder lies on, such as "fuse.sshfs"; empty: not known.
  std::function<std::string(const std::filesystem::path&)> mount_kind;
  std::function<bool(const std::filesystem::path&)> exists;
};
PlaceProbe system_probe();

/// What is wrong with the place of a database, each with its reason and what to do; empty: nothing is known
/// against it. The folder may not be there yet. Links are followed.
std::vector<std::string> place_problems(const std::filesystem::path& database,
                                        const PlaceProbe& probe = system_probe());

/// Prints them on stderr.
void warn_of_place(const std::filesystem::path& database);

}  // namespace apps
