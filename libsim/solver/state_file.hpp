#pragma once
/// The file of a run's whole state (Simulation::save_state, SimulationOptions::resume_from): a fixed first
/// line, a format number, the run's key, and a body with its SHA-256.

#include <filesystem>
#include <string>
#include <string_view>

#include "libsim/simulation.hpp"

namespace sim {

/// Increase when the layout of the body or the contents of the key change.
inline constexpr int state_file_format = 6;

/// SHA-256 of the scene and of all options that must be equal to resume a state: among others method, n_*,
/// back end, levels, sim::Readings, seed, capacity and numbers of the solver. The source of tau, the frame
/// rate tolerance, is not part of the key: runs with equal keys and equal tau continue identically from one
/// state.
std::string run_key(const Scene& scene, const SimulationOptions& options);

/// Writes a temporary file and renames it. base::Error on failure.
void write_state_file(const std::filesystem::path& path, std::string_view key, std::string_view body);

/// The body of a state with this `key`. base::Error, with the path, if the file is missing, is not a state
/// file, has another format, belongs to another run, or is damaged or truncated.
std::string read_state_file(const std::filesystem::path& path, std::string_view key);

}  // namespace sim
