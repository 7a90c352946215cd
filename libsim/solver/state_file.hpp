#pragma once
/// The file of a run's whole state (Simulation::save_state, SimulationOptions::resume_from): a magic, a
/// format's number, the run's key, and a body with its SHA-256.

#include <filesystem>
#include <string>
#include <string_view>

#include "libsim/simulation.hpp"

namespace sim {

/// Another layout of the body has another number.
inline constexpr int state_file_format = 3;

/// SHA-256 over what a state belongs to: scene, method, n_*, back end, levels, readings and numbers of the
/// solver. Two runs with one key go on alike from one state.
std::string run_key(const Scene& scene, const SimulationOptions& options);

/// Writes to a name of its own and renames. base::Error when that fails.
void write_state_file(const std::filesystem::path& path, std::string_view key, std::string_view body);

/// The body of a state that belongs to `key`. base::Error at the path: missing, no state file, another
/// format, of another run, damaged or cut short.
std::string read_state_file(const std::filesystem::path& path, std::string_view key);

}  // namespace sim
