#pragma once
/// What programs read of a run's particles, on the host.

#include <cstdint>
#include <vector>

#include "libsim/simulation.hpp"
#include "libsim/solver/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

constexpr float radius_per_support = 0.25f;  ///< h = 4 r

/// sim::ParticleField in the particles' order; 0 where its column is not there, 1 for Active.
std::vector<float> field_of(const Particles& particles, ParticleField field);

/// One entry a particle; `parts` may be empty.
void pack_saliency(const std::vector<float>& s, const std::vector<std::uint8_t>& target,
                   const std::vector<SaliencyParts>& parts, std::vector<ParticleSaliency>& out);

/// What the water holds and what has come and gone; all zero without temperatures.
HeatReport heat_of(const FluidState& state);

LevelEvents events_of(const LevelCounts& counts);

/// What the state tells of itself: all but frame, time, substeps, tau, splits and merges, and the start.
FrameReport report_of(const FluidState& state);

/// By id.
std::vector<ParticleState> states_of(const Particles& particles);

/// Place and radius of each, in the present order.
void render_particles_of(const Particles& particles, std::vector<RenderParticle>& out);
/// The same in the back end's memory, one entry a particle.
void pack_for_drawing(const Particles& particles, Vec4* out);

/// Zero where there is no foam.
FoamReport report_of(const FoamPool& pool);
/// Place and radius of each diffuse particle, which shrinks as it dissolves.
void render_foam_of(const FluidState& state, std::vector<RenderParticle>& out);
/// The same in the back end's memory, one entry for each place of the pool; free places have no radius.
void pack_foam(const FluidState& state, Vec4* out);

}  // namespace sim::SIM_BACKEND
