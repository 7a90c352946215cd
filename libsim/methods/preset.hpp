#pragma once
/// Switches for ambiguities in the paper ViP-Fluid, and two presets. `paper` follows the paper's own equation
/// wherever it is possible, with plain misprints corrected; `tuned` takes the recommended reading.
/// docs/results.md compares their pictures.

#include <string>
#include <string_view>

namespace sim {

enum class Preset { Paper, Tuned };

/// "paper" or "tuned" (any case); any other name is a base::Error.
Preset parse_preset(std::string_view name);
std::string preset_name(Preset preset);

/// ViP-Fluid Eq. 3: decrease of acuity with the eccentricity theta beyond the fovea's rim at theta_f.
/// Hyperbolic: 1 / (1 + (theta - theta_f) / 2.3 deg), like letter acuity (Strasburger et al. 2011). Steep:
/// the same formula with 0.85 deg, from the slope of the minimum angle of resolution in Guenter et al. 2012.
/// Smoothstep: to 0 at 30 deg.
enum class AcuityFalloff { Hyperbolic, Steep, Smoothstep };
/// Eq. 6: distance over which gradients are measured. OneSupport: the support h_i, so the solver's
/// neighbours. Smoothed: h_i; the values are averaged over the support before the gradients are computed,
/// and the gradients are averaged afterwards, so that the result depends on water up to three supports away.
/// TwoSupports: 2 h_i as printed, with eight times as many neighbours.
enum class GradientReach { OneSupport, Smoothed, TwoSupports };
/// Eq. 7: gamma_t, by which the temporal feature of a particle under water of thickness d, in m, is divided.
/// Min: min(e^(d/2), 5), which distinguishes thicknesses up to 3.2 m. Max: max(e^(d/2), 5), as printed.
enum class ThicknessWeight { Min, Max };
/// ViP-Fluid Eq. 9: the range of F, the weighted sum of the saliency features, that maps to the saliency s =
/// 0 .. 1. Percentile: from the 1st to the 98th percentile by mass, smoothed over frames. MinMax: from the
/// frame's minimum to its maximum. Also selects the range of the importance of Eq. 12
/// (ActivationRules::robust_range).
enum class Normalisation { Percentile, MinMax };

/// All switches. Comments name the paper's equation if the switch belongs to one. d_* is the diameter of the
/// finest particles. Without gravity, 0.01 d_* per frame replaces the speed sqrt(g d_*) in Eq. 6, 13 and 14.
struct Readings {
  // ViP-Fluid Eq. 1-9: saliency
  double alpha = 2.0 / 3;  ///< Eq. 1: weight of the temporal feature
  AcuityFalloff falloff = AcuityFalloff::Hyperbolic;
  double fovea_half_angle_deg = 7.5;
  double image_plane_m = 1;  ///< Eq. 4: distance z_Pi of the image plane from the eye
  ThicknessWeight thickness = ThicknessWeight::Min;
  double attenuation_per_m = 0.5;                    ///< Eq. 7: the factor 1/2 in e^(d/2)
  bool calm_out_of_view = true;                      ///< Eq. 6: f_T = 0 for particles outside the picture
  int manifold_window_px = 32;                       ///< Eq. 5: largest half side of the window
  bool hide_manifold_behind = false;                 ///< f_m of Eq. 5 is divided by gamma_t of Eq. 7
  GradientReach gradient = GradientReach::Smoothed;  ///< Eq. 6: reach of the gradients
  /// ViP-Fluid Eq. 6: weight of a frame's new value in the smoothed temporal feature; 1 = no smoothing.
  /// Smaller weights cause fewer splits in still water.
  double temporal_follow = 0.2;
  /// Minimum number of frames between two measurements of the temporal feature and of the range of Eq. 9. The
  /// smoothing then takes one step for each frame that passed. Acuity and manifold are measured in every
  /// update of the levels. >= 1
  int temporal_period_frames = 2;
  /// Eq. 6: gradients are multiplied by h_i, which makes them dimensionless; false: they stay in 1/m.
  bool dimensionless = true;
  /// Eq. 6: speed_floor is epsilon_v as a share of sqrt(g d_*), d_* being the diameter of the finest
  /// particles; density_floor is epsilon_rho as a share of rho_0. Without these floors, the jitter that
  /// splits and merges cause in still water would be salient.
  double speed_floor = 1;
  double density_floor = 1e-3;
  Normalisation normalisation = Normalisation::Percentile;
  /// Limit speed of water at rest, as a share of sqrt(g d_*); 0 = no water counts as at rest. kick_filter and
  /// calm_viscosity weaken as the speed rises to this limit. calm_floor and calm_dead_band apply in full up
  /// to about this speed and fall to 0 at 1.5 times it.
  double calm_speed = 0.65;
  /// ViP-Fluid Eq. 6: in water at rest this value is subtracted from the temporal feature, down to 0 at
  /// least, before the occlusion gamma_t (Eq. 7) divides the feature. Otherwise the motion that splits and
  /// merges cause would trigger further splits. Simulation::measure_saliency does not subtract it.
  double calm_floor = 0.3;
  /// Eq. 9: lower limit of the F (sum of features) that maps to s = 1; if all F are smaller, no particle has
  /// the saliency s = 1
  double saliency_floor = 0.1;
  /// Eq. 9: below this share of rho_0 a particle does not merge; 0 = all may merge. The density counts walls.
  /// Away from walls it is 0.2 for a particle alone, and 0.36 for three at distances of d and in a thread one
  /// particle wide.
  double drop_density = 0.4;
  /// Duration for which a lost gaze keeps its last direction, before it follows the view's axis; a blink
  /// lasts 0.1 to 0.4 s.
  double gaze_hold_s = 0.5;

  // Algorithms 1 and 2: levels
  /// Number of frames from one turn, the update of saliency, splits and merges, to the next. >= 1
  int levels_period_frames = 4;
  /// Angle of a gaze movement since the last turn above which the coming frame and the next saccade_frames
  /// frames are turns too, so that the new fixation is refined as soon as possible.
  double saccade_deg = 2;
  int saccade_frames = 5;
  /// Limit the difference between the target levels of neighbours to one level.
  bool graded_targets = true;
  /// Distance of the children from the parent's centre, in radii of the parent, for splits into 2^k children,
  /// k = 1, 2, 3. The paper gives 0.794 for every split.
  double split_offset[3] = {0.794, 1.09, 0.866};
  /// Maximum share of the particles that may split in one turn, an update of the levels. If it is below 1,
  /// two particles within one spacing of each other also do not split in the same turn. 1 = neither limit
  /// applies.
  double split_share = 0.05;
  /// Two particles merge only if their target levels are equal; false: both targets only need to be coarser
  /// than the particles.
  bool merge_same_target = false;
  /// Maximum distance of each of two merging particles from the merged particle's centre, in radii of the
  /// merged particle. Particles that have long found no partner may be farther away
  /// (LevelRules::looks_farther, relays).
  double merge_reach = 1;
  /// Minimum distance of a merged particle from others of its level or coarser, as a share of the sum of
  /// radii.
  double merge_overlap = 0.8;
  /// Refuse merges after which a neighbour's level or target would be two or more levels finer than the
  /// merged particle. The level of a neighbour that has long waited to merge does not count
  /// (LevelRules::lags).
  bool merge_keeps_steps = true;
  /// A particle becomes coarser only if N (1 - s) of ViP-Fluid Eq. 9 exceeds the next coarser level by at
  /// least this number. So a particle whose s varies about the border of two levels does not alternately
  /// split and merge. [0, 1)
  double merge_dead_band = 0.7;
  /// Added to merge_dead_band for particles at rest of level 1 or coarser: in full up to about the limit
  /// speed of calm_speed, falling to 0 at 1.5 times it. Each merge stirs still water a little, and stirred
  /// water splits and merges again (docs/decisions.md, "Still water with levels"). >= 0
  double calm_dead_band = 0.7;
  /// Strength of a filter of velocity changes near particles that just split or merged. In a substep the
  /// filter removes up to this share of the differences between neighbours' velocity changes, and most in
  /// water at rest. Otherwise the overlap of the new particles would become kinetic energy. [0, 1]; 0 = no
  /// filter.
  double kick_filter = 0.9;
  /// Additional viscosity of water at rest, as a multiple of the fluid's viscosity: damps the irregularities
  /// left by splits and merges. >= 0
  double calm_viscosity = 20;

  // Algorithm 3: temporal acceleration
  /// Eq. 14: the difference dV/dl of the mean velocity V between levels l is divided by |V| + epsilon, which
  /// makes it dimensionless; false: it stays in m/s.
  bool dimensionless_levels = true;
  /// An inactive particle is not solved in every second substep; the frame's last substep solves all. Gravity
  /// and the coarse pressure move it meanwhile. The next substep's correction and viscosity then count over
  /// both substeps, and at the frame's end it takes the velocity change that it lacks, in comparison with the
  /// particles that were always solved in its cell. Particles that just split or merged, fast particles, and
  /// particles without a velocity of the grid are always solved. false, as in Algorithm 3: it is not solved
  /// in the whole frame and takes the mean velocity of its cell.
  bool rest_within_frame = true;
  /// Edge of the cells for velocity changes, in diameters d_* of the finest particles; the paper's cells for
  /// mean velocity and kinetic energy have an edge of 10 d_*.
  double change_cell_spacings = 5;
  /// In the denominator of lambda, the multiplier of the density constraint, inactive particles count as if
  /// they could move; false: as if their mass were infinite.
  bool inactive_yield = true;
};

Readings readings_of(Preset preset);

}  // namespace sim
