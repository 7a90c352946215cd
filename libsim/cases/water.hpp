#pragma once
/// Scenes of the hard cases, and what is measured on their particles, on the host and independent of the
/// solver's own measures.

#include <optional>

#include "libsim/scene/fill.hpp"
#include "libsim/simulation.hpp"

namespace sim::cases {

inline constexpr double d = 0.15;  ///< spacing of the finest particles, m
inline constexpr double gravity = 9.81;

using State = std::vector<ParticleState>;

/// A tank with a block of water in its corner, without a file. The participant stands before it.
Scene tank(const Vec3d& size, const Vec3d& water, int settle_frames = 0);

/// Height of about so many layers of spacing d, m; an even number, which LoRes halves, and two at least.
double even_layers(double layers);

/// Level and spacing, m, of the particles that a method starts with where the finest lie d apart.
int start_level(MethodKind method);
double start_spacing(MethodKind method);

/// The lattice of particles that a method starts with in the box, at one velocity; ids from `first_id`.
State block(MethodKind method, const Vec3d& low, const Vec3d& high, const Vec3d& velocity = {},
            int first_id = 0);

/// Mass in m_*: 2^level.
double mass(const ParticleState& p);
double mass(const State& state);
double speed(const ParticleState& p);
double centre_height(const State& state);   ///< of mass, m
double rms_speed(const State& state);       ///< by mass, m/s
double kinetic_energy(const State& state);  ///< over m_*, m2/s2
/// Height below which this share of the mass lies, m.
double height_of_share(const State& state, double share);
/// Particles outside [0, size] in x and z or below the floor by more than `tolerance_m`, or not finite.
int outside(const State& state, const Vec3d& size, double tolerance_m);

/// Distance of each particle's nearest over the mean of their spacings, in rising order; 2 at most.
std::vector<double> nearest_distances(const State& state);

/// A pool of 8 finest layers that has settled, 4,096 particles of HiRes, seen from in front of it.
struct Pool {
  static constexpr std::int64_t n_star = 512;
  Scene scene;
  State state;
};
/// Settles once for each back end; from any thread.
const Pool& settled_pool(Backend backend);

/// One eye at the view's place that looks at `point`. `valid`: the tracker's word.
Looks look_at(const Scene& scene, const Vec3d& point, bool valid = true);

}  // namespace sim::cases
