#pragma once
/// Start positions of the particles, by one rule for all scenes and every n_* (number of particles if all are
/// coarsest).

#include <vector>

#include "libsim/methods/method.hpp"
#include "libsim/scene/scene.hpp"

namespace sim {

/// Volume of all blocks of water, including the parts that obstacles displace.
double water_volume_m3(const Scene& scene);
double volume_m3(const WaterBlock& block);

/// Error text for a gate (walls that enclose the water until it has settled) in a scene with several blocks
/// of water, and its advice.
inline constexpr const char* gate_of_several = "encloses one block of water, and there are several";
inline constexpr const char* no_gate = "write gate = false";

/// Resolution that follows from the volume V of a scene's water and n_*, the number of particles if all have
/// the coarsest level.
struct Resolution {
  double finest_spacing_m = 0;  ///< d_* = 2 r_*: cbrt(V / (8 n_*))
  double spacing_m = 0;         ///< d of the particles at frame 0: 2 d_* for LoRes, d_* for other methods
  int level = 0;  ///< level of these particles: 3 (mass 8 m_*) for LoRes, 0 (m_*) for other methods
};
Resolution resolution_of(const Scene& scene, MethodKind method, std::int64_t n_star);

/// The scene without the effects that act on no water of finest_level or coarser (is_idle()). The solver
/// simulates this scene.
Scene acting_scene(Scene scene, int finest_level);
/// The scene without the effects that act on no particle of the method, whose finest level is that of its
/// start. The renderer draws this scene.
Scene acting_scene(Scene scene, MethodKind method);

/// Exactly particle_count(method, n_star) points, minus those inside obstacles, block by block. Each block
/// has its share of the points by volume, rounded by largest remainders. A block is filled in layers from its
/// floor up, of which the last may be partial. A layer has nx = round(Lx / d) by nz = round(Lz / d) points,
/// with the block's sides Lx and Lz and d = Resolution::spacing_m; the vertical pitch is d^3 / ((Lx / nx)(Lz
/// / nz)).
std::vector<Vec3d> fill_positions(const Scene& scene, MethodKind method, std::int64_t n_star);

/// Substeps per frame: max(min_substeps, ceil(v_ref dt / (0.5 x 4 r_*))), the same for all methods of a scene
/// and n_*. dt: duration of a frame; 4 r_*: support of the finest particles.
int substeps_of(const Scene& scene, std::int64_t n_star);

/// Kinematic viscosity, m2/s, the same for all methods, levels and time steps: the scene's value or, if
/// absent, 0.05 h sqrt(g h) with the support h of particles of level 3. With less viscosity, the solver's
/// jitter stirs water at rest. The default goes to zero with h.
double viscosity_of(const Scene& scene, std::int64_t n_star);

/// Dimensionless numbers of a scene. They use the shortest side of all blocks of water as the length L,
/// time.v_ref_m_s as the speed v, the viscosities of the water and of the effect, the size g of gravity,
/// and the tension sigma of the effect cohesion. A number is 0 if its numerator is 0, and otherwise infinite
/// if its divisor is 0.
struct Scales {
  double length_m = 0, speed_m_s = 0;
  double viscosity_m2_s = 0;  ///< nu, of the water and of the effect
  double reynolds = 0;        ///< v L / nu
  double weber = 0;           ///< rho_0 v^2 L / sigma
  double bond = 0;            ///< rho_0 g L^2 / sigma
};
Scales scales_of(const Scene& scene, std::int64_t n_star);

}  // namespace sim
