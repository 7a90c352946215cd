#pragma once
/// Particle data that programs read, on the host.

#include <cstdint>
#include <utility>
#include <vector>

#include "libsim/simulation.hpp"
#include "libsim/solver/stages/fluid_state.hpp"
#include "libsim/surface/ellipsoids.hpp"

namespace sim::SIM_BACKEND {

constexpr float radius_per_support = 0.25f;  ///< a particle of support h has the radius h / 4

/// The values of `field` in the particles' order. If the solver has no such column: 0, or 1 for Active.
std::vector<float> field_of(const Particles& particles, ParticleField field);

/// Fills `out` with one entry per particle. `parts` may be empty; the parts of saliency are then 0.
void pack_saliency(const std::vector<float>& s, const std::vector<std::uint8_t>& target,
                   const std::vector<SaliencyParts>& parts, std::vector<ParticleSaliency>& out);

/// Heat held by the water, and heat that entered or left; all zero without temperatures.
HeatReport heat_of(const FluidState& state);

LevelEvents events_of(const LevelCounts& counts);
/// A state of saliency for a measurement beside the run.
SaliencyState observer_of(const Readings& readings, int levels);
PartTimes times_of(const PartClock& clock);
/// Simulation::particle_bytes.
std::size_t bytes_of(const FluidState& state);
/// The radii of the levels from the first to the second, m.
std::vector<float> radii_of(const LevelSupports& supports, std::pair<int, int> levels);
/// base::Error if a number is out of range.
void check_live(const LiveNumbers& numbers);

/// The report of the state. The caller sets its frame, time, substeps, temporal acceleration, splits and
/// merges, and start.
FrameReport report_of(const FluidState& state);

/// The state of every particle, ordered by id.
std::vector<ParticleState> states_of(const Particles& particles);

/// Position and radius of each particle, in the present order.
void render_particles_of(const Particles& particles, std::vector<RenderParticle>& out);
/// Writes position and radius of each particle to `out`, in the back end's memory.
void pack_for_drawing(const Particles& particles, Vec4* out);

/// The particles as input of their ellipsoids. `turns`: their levels change, so that pictures are blended.
SurfaceParticles surface_particles_of(const FluidState& state, bool lid, int frame, bool turns);

/// Counts of foam particles; all zero without foam.
FoamReport report_of(const FoamPool& pool);
/// Position and radius of each foam particle. The radius shrinks to 0 while the particle dissolves.
void render_foam_of(const FluidState& state, std::vector<RenderParticle>& out);
/// Writes position and radius of each slot of the foam's pool to `out`, in the back end's memory; unused
/// slots have radius 0.
void pack_foam(const FluidState& state, Vec4* out);

}  // namespace sim::SIM_BACKEND
