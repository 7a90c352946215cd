#pragma once
/// Temporal acceleration (ViP-Fluid section 4.3, Algorithm 3, Eq. 12-14): while the frame rate tolerance tau
/// is negative, the solver skips some particles in each frame; they inherit velocities from the velocity
/// grid.

#include "libsim/activation/percentile_range.hpp"
#include "libsim/activation/velocity_grid.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/particles/random.hpp"
#include "libsim/particles/selection.hpp"

namespace sim::SIM_BACKEND {

/// Settings of ViP-Fluid's Algorithm 3 in the form that kernels use; sim::Readings documents each.
struct ActivationRules {
  explicit ActivationRules(const Readings& readings = {})
      : relative_level_change(readings.dimensionless_levels),
        within_frame(readings.rest_within_frame),
        robust_range(readings.normalisation == Normalisation::Percentile),
        inherit_change(readings.inherit_change),
        pressed(readings.inactive_pressed && readings.inherit_change),
        near_spacings(static_cast<float>(readings.inherit_cell_spacings)),
        damping(static_cast<float>(readings.inactive_damping)),
        others_yield(readings.inactive_yield),
        keep_fragile_active(readings.keep_fragile_active),
        longest_rest(readings.longest_rest_frames),
        least_work(readings.least_work_frames),
        speed_floor(static_cast<float>(readings.speed_floor)) {}

  bool relative_level_change;
  bool within_frame;  ///< particles rest for one substep, not for the whole frame
  /// The importance F_pim is normalised between two bounds that follow its 1st and 99th percentile, in each
  /// frame by a tenth of the difference; false: between the frame's minimum and maximum.
  bool robust_range;
  bool inherit_change;
  bool pressed;  ///< gravity and coarse pressure move unsolved particles too; only with inherit_change
  float near_spacings;
  float damping;
  bool others_yield;
  /// Always solve: particles just made by a split or a merge, spray (less than a fifth of the neighbours of a
  /// particle inside water), with the effect cohesion also the water's surface (rest_sparse), particles
  /// within h of a wall or an obstacle, and particles faster than h / 2 per substep.
  bool keep_fragile_active;
  int longest_rest;
  int least_work;
  /// epsilon_v of ViP-Fluid Eq. 13-14, as a share of sqrt(g d_*) with d_* the spacing of level 0; epsilon_E =
  /// m_* epsilon_v^2 / 2
  float speed_floor;
};

/// Bit fields of Column::Rest: the bits of a counter of inactive frames and of the solved frames after them
/// (Choose::count_after), and two flags.
constexpr std::uint8_t rest_count_mask = 0x0f;
constexpr std::uint8_t rest_nowhere = 0x40;  ///< flag: the velocity grid has no velocity at the particle
/// flag: when it was last solved, the particle's density was below sparse_density, or below surface_density
/// with the effect cohesion
constexpr std::uint8_t rest_sparse = 0x80;

/// rho / rho_0 of a particle with a fifth of the neighbours of a particle inside water: 0.194 from itself,
/// plus a fifth of the neighbours' 0.806.
constexpr float sparse_density = 0.194f + 0.2f * 0.806f;

/// Replaces sparse_density in scenes with the effect cohesion (surface tension). Particles at the water's
/// surface are then always solved, because the mean velocity change of a cell does not contain their
/// acceleration by the tension.
constexpr float surface_density = 0.98f;

/// Value of Column::Active: the particle is solved, but excluded from the sums over solved particles
/// (Whose::Solved), and so from the cell means that unsolved particles inherit.
constexpr std::uint8_t solved_apart = 2;

using ActiveListView = ColumnView<columns(Column::Predicted), ColumnSet{}, columns(Column::Active),
                                  columns(Column::Lambda, Column::Density, Column::PredictedNext)>;

/// Index of a sum in Activation::before and after: over the solved particles, by the cell of Activation::near
/// in which each particle started the frame.
constexpr int sum_of_solved = 0;
/// index of the same sum over the unsolved particles; only with ActivationRules::pressed
constexpr int sum_of_resting = 1;
/// Indices of sums in Activation::after alone, by present position: sum_of_grid on the cells of
/// Activation::grid (solved particles; all particles in frames that solve all), sum_of_near on those of
/// Activation::near (solved particles).
constexpr int sum_of_grid = 2;
constexpr int sum_of_near = 3;

/// State of temporal acceleration. The velocities and energies of both grids, the range that normalises the
/// importance, the members slots and slot_of of the last substep, and the flags columns_set and all_marked
/// last from frame to frame. Rules, beta, seed and frame are inputs. All other members are rebuilt in each
/// frame that needs them.
struct Activation {
  ActivationRules rules;
  float beta = 1;  ///< lowest probability that a particle is solved; 1 = all particles are solved
  std::uint32_t seed = 1;
  std::uint32_t frame = 0;  ///< frames before the present one; part of the key of the random numbers

  VelocityGrid grid;  ///< mean velocity V^n and kinetic energy E^n per cell
  /// Mean velocities on the cells from which unsolved particles inherit; finer than the cells of V and E.
  VelocityGrid near;
  PercentileRange range;
  Array<float> importance;   ///< F_pim, ViP-Fluid Eq. 12
  Array<float> probability;  ///< p_i that particle i is solved, ViP-Fluid Algorithm 3 line 8
  bool columns_set = false;  ///< true once the columns Active and Rest have been written
  bool all_marked = false;   ///< true while Active is 1 for all particles
  bool some_rest = false;    ///< true during a frame in which particles may rest
  bool rests_within_frame() const { return some_rest && rules.within_frame; }

  // Inputs of ViP-Fluid's Eq. 13 and 14 per cell: differences of V between cells along x, y and z,
  // differences of V between levels, V summed over levels, differences of E between cells along x, y and z.
  Array<Vec4> slope_x, slope_y, slope_z, across_levels, total, energy_slope;
  CellMomentum before, after;  ///< sums before and after the solve; see sum_of_solved
  Array<Vec4> change;          ///< velocity change that unsolved particles inherit

  Array<int> ranks, slots, slot_of;
  Scanner scanner;

  /// Fills `slots` with the active particles first, for the passes of a substep; slot_of is the inverse of
  /// slots. Active particles also read the values of inactive neighbours, so this sets Lambda = 0, Density =
  /// 1 (rho_0) and PredictedNext = Predicted for all inactive particles.
  void list_active(ActiveListView particles);
  std::size_t bytes() const;
};

}  // namespace sim::SIM_BACKEND
