#pragma once
/// Where the protocol lies that a user names.

#include <filesystem>

namespace study {

/// A protocol file as given when it exists. Otherwise one that ships with the project, by its path
/// ("protocols/ptpe_pilot.toml") or by its name alone ("ptpe_pilot"). base::Error when there is neither; it
/// lists the names that ship.
std::filesystem::path find_protocol(const std::filesystem::path& named);

}  // namespace study
