#pragma once
/// Cache of settled states: programs need not compute the frames of settling again.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libsim/simulation.hpp"

namespace sim {

/// $VIP_CACHE_DIR, else vip-lab in $XDG_CACHE_HOME or in ~/.cache; empty (cache disabled) if none is set or
/// VIP_CACHE_DIR is empty.
std::filesystem::path default_cache_folder();

/// Hash of everything that a settled state depends on: scene file, effects (a study varies them within one
/// file), method, n_*, back end, solver numbers with the frame time, and the bytes of the solver's libraries,
/// so that a changed solver never reads an old state. Programs of one build share their states.
std::string settled_key(const Scene& scene, const SimulationOptions& options);

/// The state stored under `key`; none if it is missing or damaged (a wrong checksum, values that are not
/// finite, ids or levels out of range), which is not an error.
std::optional<std::vector<ParticleState>> read_settled(const std::filesystem::path& folder,
                                                       const std::string& key);
/// Stores a state atomically, and deletes states that were neither written nor read in the last 30 days. An
/// unwritable folder is not an error: the next run settles again.
void write_settled(const std::filesystem::path& folder, const std::string& key,
                   const std::vector<ParticleState>& state);

}  // namespace sim
