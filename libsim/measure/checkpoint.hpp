#pragma once
/// The particles with which Table 1's runs start: those of HiRes (all finest) at a checkpoint, perturbed by
/// an ulp, and merged to each method's target levels for one of several gaze points.

#include <cstdint>
#include <vector>

#include "libsim/simulation.hpp"
#include "libsim/view/gbuffer.hpp"

namespace measure {

/// The particles and the picture of a run of HiRes, the reference method, at one frame.
struct Checkpoint {
  int frame = 0;
  std::vector<sim::ParticleState> state;  ///< ordered by id
  sim::GBuffer seen;                      ///< picture of this frame
};

/// `count` different gaze points at a frame: the scene's own gaze at that frame, then the points of its other
/// keys, nearest in time first, ties to the earlier one. base::Error if the scene names fewer.
std::vector<sim::Vec3d> gaze_points(const sim::Scene& scene, int frame, int count);

/// Moves each coordinate one ulp (at most 2^-23 of its magnitude) up or down; the direction depends only on
/// id, axis and repeat. Repeat 0 returns the state unchanged.
std::vector<sim::ParticleState> perturbed(const std::vector<sim::ParticleState>& state, int repeat);

/// The target level of each particle of `state`, in the order of `state`: values[i] belongs to the particle
/// ids[i]. base::Error if a particle has no value.
std::vector<std::uint8_t> targets_by_id(const std::vector<sim::ParticleState>& state,
                                        const std::vector<int>& ids,
                                        const std::vector<sim::ParticleSaliency>& values);

}  // namespace measure
