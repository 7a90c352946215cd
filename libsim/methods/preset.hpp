#pragma once
/// Where the paper can be read in more than one way: one switch each, two presets. `paper` follows the
/// paper's own equation wherever it is possible, with plain misprints mended; `tuned` takes the reading that
/// is recommended. docs/figures.md compares their pictures.

#include <string>
#include <string_view>

namespace sim {

enum class Preset { Paper, Tuned };

/// "paper" or "tuned" (any case); others are a base::Error.
Preset parse_preset(std::string_view name);
std::string preset_name(Preset preset);

/// Eq. 3: how acuity falls beyond the fovea's rim at theta_f. Hyperbolic: 1 / (1 + (theta - theta_f) / 2.3
/// deg), as letter acuity does (Strasburger et al. 2011). Steep: the same with 0.85 deg, from the slope of
/// the minimum angle of resolution in Guenter et al. 2012. Smoothstep: to 0 at 30 deg.
enum class AcuityFalloff { Hyperbolic, Steep, Smoothstep };
/// Eq. 6: reach of the gradients. OneSupport: the solver's neighbours. Smoothed: the same between averages
/// over the support, averaged again, which reaches as far as two supports. TwoSupports: 2 h_i, as printed;
/// eight times the neighbours.
enum class GradientReach { OneSupport, Smoothed, TwoSupports };
/// Eq. 7: min(e^(d/2), 5), which tells depths up to 3.2 m apart, or the printed max.
enum class ThicknessWeight { Min, Max };
/// Eq. 9: from the 1st to the 98th percentile of the water with a moving average, or from the least to the
/// largest value.
enum class Normalisation { Percentile, MinMax };

/// Every switch. Units and readings: the equations they name.
struct Readings {
  // Eq. 1-9: saliency
  double alpha = 2.0 / 3;  ///< Eq. 1: weight of the temporal feature
  AcuityFalloff falloff = AcuityFalloff::Hyperbolic;
  double fovea_half_angle_deg = 7.5;
  double image_plane_m = 1;  ///< z_Pi, Eq. 4
  ThicknessWeight thickness = ThicknessWeight::Min;
  double attenuation_per_m = 0.5;                    ///< the 1/2 of Eq. 7
  bool calm_out_of_view = true;                      ///< Eq. 6: f_T = 0 where the picture shows nothing
  int manifold_window_px = 32;                       ///< Eq. 5: largest half side of the window
  bool hide_manifold_behind = false;                 ///< Eq. 5: f_m of covered particles divided by gamma_t
  GradientReach gradient = GradientReach::Smoothed;  ///< Eq. 6
  /// Eq. 6: share of the way to the new value that the temporal feature goes in a frame; 1 = all of it. In
  /// still water 0.3 makes a third fewer splits than 1, and 0.1 less than half as many.
  double temporal_follow = 0.2;
  /// The temporal feature and the range of Eq. 9 are measured anew after so many frames at the earliest, and
  /// followed as far as in each of them; acuity and manifold are of every turn of the levels. >= 1
  int temporal_period_frames = 2;
  /// Eq. 6: differences times h_i, without unit; false leaves 1/m.
  bool dimensionless = true;
  /// Eq. 6: epsilon_v as a share of sqrt(g d_*), epsilon_rho as a share of rho_0; without this floor the
  /// jitter of still water is salient. Splits and merges stir it at 0.2 to 0.3 sqrt(g d_*): at 0.1 the ranks
  /// of Smoothed in still water agree with those of TwoSupports at 0.86, at 0.25 at 0.92, at 1 at 0.96.
  double speed_floor = 1;
  double density_floor = 1e-3;
  Normalisation normalisation = Normalisation::Percentile;
  /// Speed below which water counts as at rest, as a share of sqrt(g d_*); 0 = none does.
  double calm_speed = 0.65;
  /// Eq. 6: in water at rest only what exceeds this counts. Splits and merges stir it, and what they stir
  /// would make the next ones. Levels follow this; masks and figures do not.
  double calm_floor = 0.3;
  double saliency_floor = 0.1;  ///< F that counts as s = 1 at least, however calm the rest
  /// How long a lost gaze stays where it was, before it follows the view's axis; a blink lasts 0.1 to 0.4 s.
  double gaze_hold_s = 0.5;

  // Algorithms 1 and 2: levels
  /// Saliency, splits and merges have a turn in every so many frames. >= 1
  int levels_period_frames = 4;
  /// They have one at once, and in each of the next frames, when a gaze has turned by more than this since
  /// the last turn: what is looked at becomes fine as soon as it can.
  double saccade_deg = 2;
  int saccade_frames = 5;
  /// Targets of neighbours differ by one level at most.
  bool graded_targets = true;
  /// Offsets of children in radii of the parent for k = 1, 2, 3. The paper gives 0.794 for each split.
  double split_offset[3] = {0.794, 1.09, 0.866};
  /// At most this share of the particles splits in a turn, and no two within one spacing; 1 = no throttle.
  double split_share = 0.05;
  /// Partners of a merge must want the same level; false: both want a coarser one.
  bool merge_same_target = false;
  /// Farthest members from the merged particle's centre, in its radii.
  double merge_reach = 1;
  /// A merged particle keeps this share of the sum of radii from others of its level or coarser.
  double merge_overlap = 0.8;
  /// A merge may not leave a neighbour two levels finer.
  bool merge_keeps_steps = true;
  /// Who would become coarser must lie this far, in levels, beyond the border that Eq. 9 draws with s: what
  /// hovers about a border neither splits nor merges. [0, 1)
  double merge_dead_band = 0.7;
  /// Share of the differences between neighbours' velocity changes that is evened out in a substep round
  /// fresh particles of water at rest, whose overlap would otherwise set energy free. [0, 1]; 0 = no filter.
  double kick_filter = 0.9;
  /// Viscosity that water at rest has besides its own, as a multiple of it: what splits and merges have left
  /// uneven comes to rest. >= 0
  double calm_viscosity = 20;

  // Algorithm 3: temporal acceleration
  /// Eq. 14: dV/dl over |V| + epsilon, without unit; false leaves m/s.
  bool dimensionless_levels = true;
  /// Frames that a particle may stay inactive in a row; 0 = no limit.
  int longest_rest_frames = 1;
  /// Frames in a row that it is then solved at least. With 2 the centre of mass of a dam of 32,768 particles
  /// stays within 2 % of the full solve's for 10 s at beta 0.3 (82 % of the particles solved, four seeds: 1.3
  /// to 1.9 %); with 1 it does so with some seeds only (76 %; 2.0 to 2.3 %). At most 14 with the rest.
  int least_work_frames = 2;
  /// Inactive particles add the mean change that their cell's solved ones met; false: take the mean velocity.
  bool inherit_change = true;
  /// Gravity and the coarse pressure move inactive particles in each substep, and what they inherit is what
  /// the projections changed beyond that; false: nothing moves them within the frame. Needs inherit_change.
  bool inactive_pressed = true;
  /// Edge of the cells that changes are inherited on, in d_*; the paper's cells for V and E have 10.
  double inherit_cell_spacings = 5;
  /// This share times (1 - beta)^2 of what they keep gives way to the mean velocity each frame.
  double inactive_damping = 0.25;
  /// The others count in lambda's denominator as if they could move; false: with no inverse mass.
  bool inactive_yield = true;
  /// Spray, particles at walls, fast ones and those just split or merged are never inactive.
  bool keep_fragile_active = true;
};

Readings readings_of(Preset preset);

}  // namespace sim
