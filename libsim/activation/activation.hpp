#pragma once
/// Temporal acceleration (ViP-Fluid section 4.3, Algorithm 3, Eq. 12-14): in a frame whose tau is negative
/// some particles are left out of the solve and inherit what the velocity grid says.

#include "libsim/activation/percentile_range.hpp"
#include "libsim/activation/velocity_grid.hpp"
#include "libsim/stages/selection.hpp"

namespace sim::SIM_BACKEND {

/// Readings of Algorithm 3 where the paper leaves a choice; the defaults are the recommended ones.
struct ActivationRules {
  /// Eq. 14: dV/dl over |V| + epsilon, without unit; false leaves m/s, as printed.
  bool relative_level_change = true;
  /// F_pim from its 1st to its 99th percentile, followed at 0.1 a frame; false: from the least to the
  /// largest.
  bool robust_range = true;
  /// Particles that are not solved keep their own velocity and add the mean change that the solved particles
  /// of their cell met; false: they take the cell's mean velocity, as printed.
  bool inherit_change = true;
  /// Gravity and the coarse pressure move the others in each substep, and they inherit what the projections
  /// changed beyond that; false: the inherited change holds everything. Needs inherit_change.
  bool pressed = true;
  /// Edge of the cells that they inherit from, in d_*. On the cells of V, 10 d_*, the mean change of a dam's
  /// front and of the water behind it is one number.
  float near_spacings = 5;
  /// Of what they keep, this share times (1 - beta)^2 gives way to the cell's mean velocity each frame:
  /// nothing slows them down when they run into others, which would feed the fluid energy.
  float damping = 0.25f;
  /// In the denominator of lambda the others count as if they could move; false: as if they had infinite
  /// mass.
  bool others_yield = true;
  /// Never left out: particles just made by a split or a merge, spray (less than a fifth of the neighbours at
  /// rest), those within h of a wall and those faster than half an h a substep.
  bool keep_fragile_active = true;
  /// Frames in a row that a particle may be left out; 0 = no limit.
  int longest_rest = 1;
  /// Frames in a row that it is then solved at least, where there is such a limit.
  int least_work = 2;
  /// epsilon_v of Eq. 13-14 as a share of sqrt(g d_*); epsilon_E = m_* epsilon_v^2 / 2.
  float speed_floor = 0.1f;
};

/// Fields of Column::Rest.
constexpr std::uint8_t rest_count_mask = 0x0f;  ///< see Choose::count_after; at most 15
constexpr std::uint8_t rest_nowhere = 0x40;     ///< the grid knows no velocity here
constexpr std::uint8_t rest_sparse = 0x80;      ///< had few neighbours when last solved

/// rho / rho_0 of a particle with a fifth of the neighbours at rest: its own share, 0.194, and a fifth of the
/// others'.
constexpr float sparse_density = 0.194f + 0.2f * 0.806f;

/// Uniform in [0, 1) from a particle, a frame and a seed alone: three rounds of a 32-bit mixer (lowbias32
/// constants, C. Wellons).
SIM_FN float activation_draw(std::uint32_t id, std::uint32_t frame, std::uint32_t seed) {
  const std::uint32_t words[3] = {seed, frame, id};
  std::uint32_t x = 0;
  for (int k = 0; k < 3; ++k) {
    x = (x ^ words[k]) + 0x9e3779b9u;
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    x ^= x >> 16;
  }
  return static_cast<float>(x >> 8) * (1.0f / 16777216.0f);
}

/// State of temporal acceleration. V, E, the range and the frame counter last; the rest is rebuilt each
/// frame.
struct Activation {
  ActivationRules rules;
  float beta = 1;  ///< lowest probability of being solved; 1 = everyone is, whatever F_pim
  std::uint32_t seed = 1;
  std::uint32_t frame = 0;  ///< number of the coming frame, part of the random numbers' key

  VelocityGrid grid;  ///< V^n and E^n
  /// Mean velocities on the cells of which the others inherit; finer than those of V and E.
  VelocityGrid near;
  PercentileRange range;
  Array<float> importance;   ///< F_pim, Eq. 12
  Array<float> probability;  ///< p_i, Algorithm 3 line 8
  bool columns_set = false;  ///< Active and Rest hold something
  bool all_marked = false;   ///< Active says 1 for everyone

  // Means over cells that Eq. 13 and 14 sample: dV/dx, dV/dy, dV/dz a cell, dV/dl, sum over levels, dE.
  Array<Vec4> slope_x, slope_y, slope_z, across_levels, total, energy_slope;
  // Momentum of the active particles, and of the others, by the cell they started in, before and after the
  // solve; what the others miss.
  Array<MomentumSum> before, after, others_before, others_after;
  Array<Vec4> change;

  Array<int> flags, ranks, slots, slot_of;
  Scanner scanner;

  /// Lists the active particles for the passes of a substep and puts what the passes read of the others in
  /// place: lambda 0, the rest density, the predicted position in both buffers. slot_of is slots' inverse.
  void list_active(Particles& particles);
  std::size_t bytes() const;
};

}  // namespace sim::SIM_BACKEND
