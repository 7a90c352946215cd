#pragma once
/// Evaluates the cells of a sweep: error and milliseconds of each setting, and the effect of turning each
/// knob.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "libstudy/sweep/picture_errors.hpp"
#include "libstudy/sweep/sweep_file.hpp"
#include "stats/figures/text_table.hpp"

namespace study {

/// Errors that a sweep reports, each in per cent; smaller is better.
enum class SweepError {
  Front,    ///< E1: root mean square over the instants of the front's distance from the reference's, over the
            ///< tank's length
  Centre,   ///< E3: the same for the centre of mass
  Kinetic,  ///< E4: the same for the kinetic energy, over the reference's maximum
  Density,  ///< E2: mean over the instants of max(rho / rho_0 - 1, 0); needs no reference
  Picture,  ///< this and all below: see PictureError; NaN if the sweep stored no pictures
  Fovea,
  Salient,
  Ssim,
  Flip,
  Film,
  Flicker
};
/// The errors of the water come first.
inline constexpr std::size_t water_error_count = 4;
inline constexpr std::size_t sweep_error_count = water_error_count + picture_error_count;
inline constexpr std::array<const char*, sweep_error_count> sweep_error_columns{
    "front_pct",   "centre_pct", "kinetic_pct", "density_pct", "picture_pct", "fovea_pct",
    "salient_pct", "ssim_pct",   "flip_pct",    "film_pct",    "flicker_pct"};
inline constexpr std::array<const char*, sweep_error_count> sweep_error_words{"front",
                                                                              "centre of mass",
                                                                              "kinetic energy",
                                                                              "density",
                                                                              "picture",
                                                                              "picture in the fovea",
                                                                              "picture where it is salient",
                                                                              "structure (SSIM)",
                                                                              "what is seen (FLIP)",
                                                                              "structure of the film",
                                                                              "flicker"};
static_assert(static_cast<std::size_t>(SweepError::Flicker) + 1 == sweep_error_count);
using SweepErrors = std::array<double, sweep_error_count>;
using WaterErrors = std::array<double, water_error_count>;

/// base::Error unless both were sampled at the same instants.
WaterErrors water_errors(const CellRun& run, const CellRun& reference, double tank_length_m);

/// Mean, smallest and largest over the seeds.
struct Spread {
  double mean = 0, low = 0, high = 0;
};

/// "1.2 [1.1, 1.3]": mean, smallest and largest.
std::string in_words(const Spread& spread);

/// A setting over all its seeds.
struct SettingResult {
  sim::SolverSetting setting;
  int seeds = 0;
  double particles = 0, substeps = 0;
  double ms_mean = 0, ms_low_quartile = 0, ms_median = 0, ms_high_quartile = 0, ms_p95 = 0;  ///< whole frames
  double draw_ms_mean = 0;  ///< part of ms_mean; NaN without pictures
  /// E8: Eq. 11 with the paper's a and b, for the frames as a display at the setting's rate shows them: no
  /// interval is shorter than its period. Frames/s.
  double tau = 0;
  std::array<Spread, sweep_error_count> errors = {};
};

/// The effect of turning one knob away from the usual setting.
struct Price {
  sim::MethodKind method{};
  sim::SolverKnob knob{};
  double from = 0, to = 0;
  double ms = 0;                                      ///< change of the mean frame
  double ms_low_quartile = 0, ms_high_quartile = 0;   ///< over the changes of frames at the same instants
  std::array<Spread, sweep_error_count> errors = {};  ///< change; low and high over all pairs of seeds
  /// True if zero lies between the quartiles: the change is within the variation of the frames.
  bool free() const { return ms_low_quartile <= 0 && ms_high_quartile >= 0; }
};

/// How fast HiRes converges under refinement: slope of log(distance of each run from the next finer one) over
/// log(step), by least squares.
struct ObservedOrder {
  std::string of;                    ///< "particle spacing" or "time step"
  std::vector<double> steps;         ///< relative to the first one
  std::array<double, 3> order = {};  ///< of Front, Centre and Kinetic; NaN if two runs are equal
};

struct PriceList {
  SweepOrigin origin;
  std::string scene;
  SweepErrors floor{};  ///< errors of a reference perturbed by an ulp: smaller errors are meaningless
  /// The reference with twice the projections, substeps and particles; empty if not run.
  std::vector<SettingResult> finer = {};
  std::vector<SettingResult> settings = {};
  std::vector<Price> prices = {};
  /// True for each error if all three finer references differ from the reference by less than a third of the
  /// smallest listed error above the floor.
  std::array<bool, sweep_error_count> converged{};
  std::vector<ObservedOrder> orders = {};  ///< of the refinements that were run
  double parting_s = 0;                    ///< as PictureScores::parting_s
  bool pictures() const { return !std::isnan(parting_s); }
};

/// Evaluates the cells of one machine, program and scene against this plan's reference. base::Error without
/// the reference and its second seed.
PriceList price_list(const std::vector<StoredCell>& cells, const SweepPlan& plan, const SweepOrigin& origin,
                     double tank_length_m);

/// Indices in `settings` of those that no other one beats in both mean milliseconds and this error, the
/// fastest first.
std::vector<std::size_t> pareto_front(const std::vector<SettingResult>& settings, SweepError error);

/// Cells with seeds 1 to `seeds` of each setting on the front of any error, in the sweep's order.
std::vector<SweepCell> more_seeds_of_fronts(const PriceList& list, const SweepPlan& plan, int seeds);

/// The values in which a setting differs from its method's default, and n_*: "n_* 512, projections 8".
std::string in_words(const sim::SolverSetting& setting);
/// "counts as converged" and the like, for the reference of an error.
std::string convergence(const PriceList& list, SweepError error);

/// "HiRes' order in the time step (1.00, 0.50, 0.25): front 1.02, ...".
std::string in_words(const ObservedOrder& order);
/// A sentence on when the pictures of the reference and of its second seed part; needs list.pictures().
std::string parting_in_words(const PriceList& list);

/// Why an error of pictures is NaN in all rows.
std::string why_no_price(const PriceList& list);

/// Tables for programs.
figures::TextTable setting_table(const PriceList& list);
figures::TextTable price_table(const PriceList& list);
/// Tables for readers: errors of the water or of the pictures.
enum class ErrorPart { Water, Pictures };
figures::TextTable settings_to_read(const PriceList& list, ErrorPart part);
figures::TextTable prices_to_read(const PriceList& list, ErrorPart part);
/// The tables for readers, with the errors' floors and the references' convergence.
std::string to_markdown(const PriceList& list);

}  // namespace study
