#pragma once
/// Scenes that could only be computed for nothing, told before memory is asked for.

#include <cstdint>
#include <optional>

#include "libsim/methods/method.hpp"
#include "libsim/scene/scene.hpp"

namespace sim {

/// base::Error that names the key when the water is thinner than a particle, a frame takes more than 1000
/// substeps, or the tank is so much larger than its water that the cells of the coarse pressure, of
/// `cell_edge_m`, would outnumber particles sixteen times (a million are always allowed).
void check_extent(const Scene& scene, MethodKind method, std::int64_t n_star, double cell_edge_m);

/// Memory that programs can have without swapping, in bytes; nothing where the system does not say.
std::optional<double> available_memory_bytes();

/// base::Error when a run on the CPU would take more than `available_bytes`: measured at 1.1 kB a particle,
/// 2.3 kB where particles split and merge. A system that promises memory it does not have ends such a program
/// without a word.
void check_memory(MethodKind method, std::int64_t n_star, std::optional<double> available_bytes);

}  // namespace sim
