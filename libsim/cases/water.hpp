#pragma once
/// Scenes of the hard cases, and measures of their particles, computed on the host and independent of the
/// solver's own measures.

#include <optional>

#include "libsim/scene/fill.hpp"
#include "libsim/simulation.hpp"

namespace sim::cases {

inline constexpr double d = 0.15;  ///< spacing of the finest particles, m
inline constexpr double gravity = 9.81;

using State = std::vector<ParticleState>;

/// The scene of a tank with a block of water in its corner, built without a scene file. The participant's
/// view is from the front.
Scene tank(const Vec3d& size, const Vec3d& water, int settle_frames = 0);

/// Height of about this many layers of spacing d, m. The number of layers is even, because LoRes halves it,
/// and at least two.
double even_layers(double layers);

/// start_level: level of the particles with which a method starts. start_spacing: their spacing if the finest
/// spacing is d, m.
int start_level(MethodKind method);
double start_spacing(MethodKind method);

/// The lattice of particles with which a method starts in the box, all with the same velocity; ids count from
/// `first_id`.
State block(MethodKind method, const Vec3d& low, const Vec3d& high, const Vec3d& velocity = {},
            int first_id = 0);

/// Mass of a particle (2^level) and of all particles, in units of m_*, the mass of a particle of level 0.
double mass(const ParticleState& p);
double mass(const State& state);
double speed(const ParticleState& p);
double centre_height(const State& state);   ///< height of the centre of mass, m
double rms_speed(const State& state);       ///< weighted by mass, m/s
double kinetic_energy(const State& state);  ///< divided by m_*, m2/s2
/// Height below which this share of the mass is, m.
double height_of_share(const State& state, double share);
/// Number of particles outside [0, size] in x and z or below the floor by more than `tolerance_m`, or not
/// finite.
int outside(const State& state, const Vec3d& size, double tolerance_m);

/// Distance from each particle to its nearest neighbour divided by the mean of their spacings, in ascending
/// order; at most 2.
std::vector<double> nearest_distances(const State& state);

/// A settled pool of 4,096 finest particles, 8 layers deep, computed with the method HiRes and seen from the
/// front.
struct Pool {
  static constexpr std::int64_t n_star = 512;
  Scene scene;
  State state;
};
/// Computes the pool at the first call for a back end; thread-safe.
const Pool& settled_pool(Backend backend);

/// The gaze of one eye at the view's position that looks at `point`. `valid`: the eye tracker's flag.
Looks look_at(const Scene& scene, const Vec3d& point, bool valid = true);

}  // namespace sim::cases
