#pragma once
/// Settled states kept between runs: 120 frames of settling need not be computed anew by every program.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libsim/simulation.hpp"

namespace sim {

/// $VIP_CACHE_DIR, else vip-lab in $XDG_CACHE_HOME or in ~/.cache; empty (keep nothing) when none is set or
/// VIP_CACHE_DIR is empty.
std::filesystem::path default_cache_folder();

/// Names everything that a settled state depends on: scene file, effects (a study varies them within one
/// file), method, n_*, back end, step, solver numbers, and the bytes of the solver's libraries, so that a
/// changed solver never reads an old state. Programs of one build share their states.
std::string settled_key(const Scene& scene, const SimulationOptions& options);

/// The state kept under `key`; nothing when there is none or it is damaged (checksum, or
/// values that are not finite), which is no error.
std::optional<std::vector<ParticleState>> read_settled(const std::filesystem::path& folder,
                                                       const std::string& key);
/// Keeps a state by rename and forgets those that nobody read for 30 days. A folder that cannot be written is
/// no error: the next run settles again.
void write_settled(const std::filesystem::path& folder, const std::string& key,
                   const std::vector<ParticleState>& state);

}  // namespace sim
