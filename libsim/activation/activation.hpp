#pragma once
/// Temporal acceleration (ViP-Fluid section 4.3, Algorithm 3, Eq. 12-14): while the frame rate tolerance tau
/// is negative, the solver skips some particles in each frame: in every second substep, or in the whole frame
/// (Readings::rest_within_frame).

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
        robust_range(readings.normalisation == Normalisation::Percentile),
        within_frame(readings.rest_within_frame),
        change_spacings(static_cast<float>(readings.change_cell_spacings)),
        others_yield(readings.inactive_yield),
        speed_floor(static_cast<float>(readings.speed_floor)) {}

  bool relative_level_change;
  /// The importance F_pim is normalised between two bounds that follow its 1st and 99th percentile, in each
  /// frame by a tenth of the difference; false: between the frame's minimum and maximum.
  bool robust_range;
  bool within_frame;
  float change_spacings;
  bool others_yield;
  /// epsilon_v of ViP-Fluid Eq. 13-14, as a share of sqrt(g d_*) with d_* the spacing of level 0; epsilon_E =
  /// m_* epsilon_v^2 / 2
  float speed_floor;
};

using ActiveListView = ColumnView<columns(Column::Predicted), ColumnSet{}, columns(Column::Active),
                                  columns(Column::Lambda, Column::Density, Column::PredictedNext)>;

/// Index of a sum in Activation::before and after: over the particles solved in every substep, by the cell of
/// Activation::change_cells in which each particle started the frame.
constexpr int sum_of_solved = 0;
/// index of the same sum over the particles that rest
constexpr int sum_of_resting = 1;
/// Index of the sum in Activation::after on the cells of Activation::grid, by present position: over solved
/// particles, or over all where particles rest within the frame or not at all.
constexpr int sum_of_grid = 2;

/// State of temporal acceleration. The velocities and energies of both grids, the range that normalises the
/// importance, the members slots and slot_of of the last substep, and the flags columns_set and all_marked
/// last from frame to frame. Rules, beta, seed and frame are inputs. All other members are rebuilt in each
/// frame that needs them.
struct Activation {
  ActivationRules rules;
  float beta = 1;  ///< lowest probability that a particle is solved; 1 = all particles are solved
  std::uint32_t seed = 1;
  std::uint32_t frame = 0;  ///< frames before the present one; part of the key of the random numbers

  VelocityGrid grid;       ///< mean velocity V^n and kinetic energy E^n per cell
  GridFrame change_cells;  ///< cells of the velocity changes; finer than the cells of V and E
  PercentileRange range;
  Array<float> importance;   ///< F_pim, ViP-Fluid Eq. 12
  Array<float> probability;  ///< p_i that particle i is solved, ViP-Fluid Algorithm 3 line 8
  /// True once the column Active has been written; false also after frames that skipped the stage activation,
  /// because effects acted. The grid's values are then out of date.
  bool columns_set = false;
  bool all_marked = false;  ///< true while Active is 1 for all particles
  bool some_rest = false;   ///< true during a frame in which particles may rest

  // Inputs of ViP-Fluid's Eq. 13 and 14 per cell: differences of V between cells along x, y and z,
  // differences of V between levels, V summed over levels, differences of E between cells along x, y and z.
  Array<Vec4> slope_x, slope_y, slope_z, across_levels, total, energy_slope;
  CellMomentum before, after;  ///< sums before and after the solve; see sum_of_solved
  Array<Vec4> change;          ///< velocity change that particles lack after they rested within the frame

  Array<int> ranks, slots, slot_of;
  Scanner scanner;

  /// True during a frame in which particles may rest in every second substep.
  bool rests_within_frame() const { return some_rest && rules.within_frame; }
  /// Fills `slots` with the active particles first, for the passes of a substep; slot_of is the inverse of
  /// slots. Active particles also read the values of inactive neighbours, so this sets Lambda = 0, Density =
  /// 1 (rho_0) and PredictedNext = Predicted for all inactive particles.
  void list_active(ActiveListView particles);
  std::size_t bytes() const;
};

}  // namespace sim::SIM_BACKEND
