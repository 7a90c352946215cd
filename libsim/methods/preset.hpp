#pragma once
/// Switches for ambiguities in the paper, and two presets. `paper` follows the paper's own equation wherever
/// it is possible, with plain misprints corrected; `tuned` takes the recommended reading. docs/results.md
/// compares their pictures.

#include <string>
#include <string_view>

namespace sim {

enum class Preset { Paper, Tuned };

/// "paper" or "tuned" (any case); others are a base::Error.
Preset parse_preset(std::string_view name);
std::string preset_name(Preset preset);

/// Eq. 3: decrease of acuity beyond the fovea's rim at theta_f. Hyperbolic: 1 / (1 + (theta - theta_f) / 2.3
/// deg), like letter acuity (Strasburger et al. 2011). Steep: the same with 0.85 deg, from the slope of the
/// minimum angle of resolution in Guenter et al. 2012. Smoothstep: to 0 at 30 deg.
enum class AcuityFalloff { Hyperbolic, Steep, Smoothstep };
/// Eq. 6: reach of the gradients. OneSupport: the solver's neighbours. Smoothed: the same on values averaged
/// over the support, with averaged results, which reaches as far as two supports. TwoSupports: 2 h_i, as
/// printed; eight times the neighbours.
enum class GradientReach { OneSupport, Smoothed, TwoSupports };
/// Eq. 7: min(e^(d/2), 5), which distinguishes depths up to 3.2 m, or the printed max.
enum class ThicknessWeight { Min, Max };
/// Eq. 9: between the 1st and the 98th percentile by mass with a moving average, or between the minimum and
/// the maximum.
enum class Normalisation { Percentile, MinMax };

/// Every switch. Units and readings: the equations they name. Without gravity, a hundredth of d_* per frame
/// stands for the speed sqrt(g d_*) in Eq. 6, 13 and 14.
struct Readings {
  // Eq. 1-9: saliency
  double alpha = 2.0 / 3;  ///< Eq. 1: weight of the temporal feature
  AcuityFalloff falloff = AcuityFalloff::Hyperbolic;
  double fovea_half_angle_deg = 7.5;
  double image_plane_m = 1;  ///< z_Pi, Eq. 4
  ThicknessWeight thickness = ThicknessWeight::Min;
  double attenuation_per_m = 0.5;                    ///< the 1/2 of Eq. 7
  bool calm_out_of_view = true;                      ///< Eq. 6: f_T = 0 outside the picture
  int manifold_window_px = 32;                       ///< Eq. 5: largest half side of the window
  bool hide_manifold_behind = false;                 ///< Eq. 5: f_m of occluded particles divided by gamma_t
  GradientReach gradient = GradientReach::Smoothed;  ///< Eq. 6
  /// Eq. 6: smoothing factor per frame of the temporal feature; 1 = no smoothing. In still water 0.3 makes a
  /// third fewer splits than 1, and 0.1 less than half as many.
  double temporal_follow = 0.2;
  /// Minimum number of frames between measurements of the temporal feature and the range of Eq. 9; smoothing
  /// then takes as many steps. Acuity and manifold are measured in every turn of the levels. >= 1
  int temporal_period_frames = 2;
  /// Eq. 6: differences times h_i, dimensionless; false leaves 1/m.
  bool dimensionless = true;
  /// Eq. 6: epsilon_v as a share of sqrt(g d_*), epsilon_rho as a share of rho_0; without this floor the
  /// jitter of still water is salient. Splits and merges stir it at 0.2 to 0.3 sqrt(g d_*): the rank
  /// correlation of Smoothed with TwoSupports in still water is 0.86 at 0.1, 0.92 at 0.25, 0.96 at 1.
  double speed_floor = 1;
  double density_floor = 1e-3;
  Normalisation normalisation = Normalisation::Percentile;
  /// Speed below which water counts as at rest, as a share of sqrt(g d_*); 0 = no water does.
  double calm_speed = 0.65;
  /// Eq. 6: in water at rest only the excess over this value counts. Splits and merges stir it, and would
  /// otherwise cause further ones. Levels use this; masks and figures do not.
  double calm_floor = 0.3;
  double saliency_floor = 0.1;  ///< minimum F that counts as s = 1, however calm the rest is
  /// Duration for which a lost gaze stays at its last position, before it follows the view's axis; a blink
  /// lasts 0.1 to 0.4 s.
  double gaze_hold_s = 0.5;

  // Algorithms 1 and 2: levels
  /// Period in frames of the turns of saliency, splits and merges. >= 1
  int levels_period_frames = 4;
  /// Further turns take place at once, and in each of the next saccade_frames frames, if a gaze has turned by
  /// more than this since the last turn: the new fixation is refined as soon as possible.
  double saccade_deg = 2;
  int saccade_frames = 5;
  /// Limit target levels of neighbours to a difference of one.
  bool graded_targets = true;
  /// Offsets of children in radii of the parent for k = 1, 2, 3. The paper gives 0.794 for every split.
  double split_offset[3] = {0.794, 1.09, 0.866};
  /// Maximum share of the particles that splits in a turn, and no two within one spacing; 1 = no throttle.
  double split_share = 0.05;
  /// Partners of a merge must have the same target level; false: both only need a coarser one.
  bool merge_same_target = false;
  /// Maximum distance of members from the merged particle's centre, in its radii.
  double merge_reach = 1;
  /// Minimum distance of a merged particle from others of its level or coarser, as a share of the sum of
  /// radii.
  double merge_overlap = 0.8;
  /// A merge may not leave a neighbour two levels finer.
  bool merge_keeps_steps = true;
  /// A particle becomes coarser only if it is this far, in levels, beyond the border that Eq. 9 gives for s:
  /// particles near a border neither split nor merge. [0, 1)
  double merge_dead_band = 0.7;
  /// Share of the differences between neighbours' velocity changes that is removed per substep near fresh
  /// particles in water at rest, whose overlap would otherwise release energy. [0, 1]; 0 = no filter.
  double kick_filter = 0.9;
  /// Additional viscosity of water at rest, as a multiple of its own: damps the irregularities left by splits
  /// and merges. >= 0
  double calm_viscosity = 20;

  // Algorithm 3: temporal acceleration
  /// Eq. 14: dV/dl divided by |V| + epsilon, dimensionless; false leaves m/s.
  bool dimensionless_levels = true;
  /// Consecutive frames that a particle may be inactive; 0 = no limit.
  int longest_rest_frames = 1;
  /// Consecutive frames that it is then solved at least. With 2 the centre of mass of a dam of 32,768
  /// particles stays within 2 % of the full solve's for 10 s at beta 0.3 (82 % of the particles solved, four
  /// seeds: 1.3 to 1.9 %); with 1 it does so with some seeds only (76 %; 2.0 to 2.3 %). At most 14 together
  /// with the rest.
  int least_work_frames = 2;
  /// Inactive particles add the mean velocity change of their cell's solved ones; false: take the mean
  /// velocity.
  bool inherit_change = true;
  /// Gravity and the coarse pressure move inactive particles in each substep, and they inherit only the
  /// projections' further change; false: they do not move within the frame. Needs inherit_change.
  bool inactive_pressed = true;
  /// Edge of the cells for inherited changes, in d_*; the paper's cells for V and E have 10.
  double inherit_cell_spacings = 5;
  /// Per frame, this share times (1 - beta)^2 of their velocity is replaced by the mean velocity.
  double inactive_damping = 0.25;
  /// Inactive particles count in lambda's denominator as if they could move; false: with no inverse mass.
  bool inactive_yield = true;
  /// Spray, particles at walls, fast ones and those that just split or merged are never inactive.
  bool keep_fragile_active = true;
};

Readings readings_of(Preset preset);

}  // namespace sim
