#pragma once
/// Checks the location of a database: not on a network file system, and not in a folder that a service copies
/// to other computers.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// Queries about file systems; tests replace them.
struct PlaceProbe {
  /// File system type of a folder (statfs, f_type); none: not known.
  std::function<std::optional<std::uint32_t>(const std::filesystem::path&)> file_system;
  /// Mount type of a folder, such as "fuse.sshfs"; empty: not known.
  std::function<std::string(const std::filesystem::path&)> mount_kind;
  std::function<bool(const std::filesystem::path&)> exists;
};
PlaceProbe system_probe();

/// Problems of a database's location, each with reason and remedy; empty: none known. The folder need not
/// exist. Symbolic links are resolved.
std::vector<std::string> place_problems(const std::filesystem::path& database,
                                        const PlaceProbe& probe = system_probe());

/// Prints place_problems() as warnings on stderr.
void warn_of_place(const std::filesystem::path& database);

}  // namespace study
