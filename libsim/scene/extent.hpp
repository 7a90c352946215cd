#pragma once
/// Checks of a scene at a given n_* (number of particles if all are coarsest), before memory is allocated:
/// water, substeps, swinging obstacles, tank and memory.

#include <cstdint>
#include <optional>

#include "libsim/methods/method.hpp"
#include "libsim/scene/scene.hpp"

namespace sim {

/// base::Error that names an obstacle whose swing leaves too little space for the water below it. Such an
/// obstacle closes the tank: all its gaps to the walls are narrower than the finest spacing, and a mesh has
/// no hole. At the lowest point of its swing, the water that was below it at the start would be deeper than
/// the space below it by more than that spacing. In a tank with a lid, the same is checked towards the lid
/// and the side walls. Not checked: scenes with a nozzle, because nozzles take water from the floor; scenes
/// with an outlet below the obstacle; tanks narrower than 3 or longer than 1024 finest spacings.
void check_ways(const Scene& scene, std::int64_t n_star);

/// Calls check_ways(). base::Error that names the key if a block of water is thinner than the finest spacing,
/// one of several blocks has less volume than a particle, a gate is to hold several blocks, a frame takes
/// more than 1000 substeps, all water would begin inside obstacles, or the tank is too large for its water:
/// the cells of the coarse pressure, of `cell_edge_m`, would be more than sixteen times as many as the
/// particles (2^20 cells are always allowed).
void check_extent(const Scene& scene, MethodKind method, std::int64_t n_star, double cell_edge_m);

/// Memory that programs can use without swapping, in bytes; none if the system does not report it.
std::optional<double> available_memory_bytes();

/// base::Error if a run on the CPU would take more than `available_bytes`: measured as 1.1 kB per particle,
/// 2.3 kB if particles split and merge. A system that overcommits memory kills such a program without a
/// message.
void check_memory(MethodKind method, std::int64_t n_star, std::optional<double> available_bytes);

}  // namespace sim
