#pragma once
/// Where the runs of Table 1 start: HiRes at a checkpoint, looked at from several gaze points, moved by an
/// ulp, and coarsened as each method asks.

#include <cstdint>
#include <vector>

#include "libsim/view/gbuffer.hpp"
#include "libsim/simulation.hpp"

namespace apps {

/// HiRes at one frame of its run.
struct Checkpoint {
  int frame = 0;
  std::vector<sim::ParticleState> state;  ///< ordered by id
  sim::GBuffer seen;                      ///< its picture
};

/// `count` different gaze points at a frame: the scene's own gaze there, then the points of its other keys,
/// nearest in time first and the earlier of two first. base::Error when the scene names fewer.
std::vector<sim::Vec3d> gaze_points(const sim::Scene& scene, int frame, int count);

/// The state with each coordinate one ulp (2^-23 of its magnitude or less) up or down, by a bit that depends
/// on id, axis and repeat alone. Repeat 0 is the state itself.
std::vector<sim::ParticleState> perturbed(const std::vector<sim::ParticleState>& state, int repeat);

/// A target for each particle of a state ordered by id: values[i] belongs to ids[i]. base::Error when a
/// particle has none.
std::vector<std::uint8_t> targets_by_id(const std::vector<sim::ParticleState>& state,
                                        const std::vector<int>& ids,
                                        const std::vector<sim::ParticleSaliency>& values);

}  // namespace apps
