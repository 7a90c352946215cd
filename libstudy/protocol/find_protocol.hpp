#pragma once
/// Finds the protocol file that a user names.

#include <filesystem>

namespace study {

/// Returns the given path if the file exists, else a protocol that ships with the project, by its path
/// ("protocols/ptpe_pilot.toml") or its name alone ("ptpe_pilot"). base::Error if there is neither; for a
/// name alone the error lists the shipped names.
std::filesystem::path find_protocol(const std::filesystem::path& named);

}  // namespace study
