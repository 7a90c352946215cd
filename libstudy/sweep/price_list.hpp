#pragma once
/// Evaluates the cells of a sweep: errors and time per frame of each setting, and the effect of changing each
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
  Front,    ///< root mean square distance between the water's fronts, over the tank's length
  Centre,   ///< root mean square distance between the centres of mass, over the tank's length
  Kinetic,  ///< root mean square difference in kinetic energy, over the reference's maximum
  Density,  ///< mean over particles and instants of max(rho / rho_0 - 1, 0); needs no reference
  Picture,  ///< this error and those below: differences of pictures, defined by PictureError
  Fovea,
  Salient,
  Ssim,
  Flip,
  Film,
  Flicker
};
/// Number of errors of the water, which are the first enumerators of SweepError.
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

/// Front, Centre, Kinetic and Density of one run. base::Error unless both runs were sampled at the same
/// instants.
WaterErrors water_errors(const CellRun& run, const CellRun& reference, double tank_length_m);

/// Mean, smallest and largest value over the seeds of a setting.
struct Spread {
  double mean = 0, low = 0, high = 0;
};

/// The spread in words, "1.2 [1.1, 1.3]": mean, smallest and largest.
std::string in_words(const Spread& spread);

/// Time and errors of one setting over all its seeds.
struct SettingResult {
  sim::SolverSetting setting;
  int seeds = 0;
  double particles = 0, substeps = 0;
  /// Time of a frame in ms, over the frames of all seeds.
  double ms_mean = 0, ms_low_quartile = 0, ms_median = 0, ms_high_quartile = 0, ms_p95 = 0;
  double draw_ms_mean = 0;  ///< mean time of drawing, contained in ms_mean; NaN without pictures
  /// Tau of the paper's Eq. 11, mu - a exp(b delta), in frames/s, with the mean mu and the standard deviation
  /// delta of the frame rate and the paper's a and b. Frame intervals are the times of the frames, but no
  /// shorter than the period of a display at the setting's frame rate.
  double tau = 0;
  std::array<Spread, sweep_error_count> errors = {};
};

/// The effect of changing one knob of a method's usual setting.
struct Price {
  sim::MethodKind method{};
  sim::SolverKnob knob{};
  double from = 0, to = 0;
  double ms = 0;  ///< change of the mean time of a frame
  /// Quartiles of the change in time between frames at the same instant, in ms.
  double ms_low_quartile = 0, ms_high_quartile = 0;
  /// Change of each error, over all pairs of one run before and one run after the change of the knob.
  std::array<Spread, sweep_error_count> errors = {};
  /// True if 0 lies between the two quartiles: the change of time is within the variation between frames.
  bool free() const { return ms_low_quartile <= 0 && ms_high_quartile >= 0; }
};

/// Observed order of convergence of HiRes: least-squares slope of log(difference between a run and the next
/// finer run) against log(step).
struct ObservedOrder {
  std::string of;                    ///< "particle spacing" or "time step"
  std::vector<double> steps;         ///< step of each run, divided by that of the first run
  std::array<double, 3> order = {};  ///< for Front, Centre and Kinetic; NaN if two runs are equal
};

struct PriceList {
  SweepOrigin origin;
  std::string scene;
  /// Errors of the reference from a start perturbed by one unit in the last place (0 for Density). Smaller
  /// errors are meaningless.
  SweepErrors floor{};
  /// Results of the finer references that were run: the reference with twice the projections, substeps or
  /// particles.
  std::vector<SettingResult> finer = {};
  std::vector<SettingResult> settings = {};
  std::vector<Price> prices = {};
  /// For each error, true if the reference counts as converged: all three finer references were run and
  /// differ from it by less than a third of the smallest error above the floor in `settings`.
  std::array<bool, sweep_error_count> converged{};
  std::vector<ObservedOrder> orders = {};  ///< for particle spacing and time step, as far as the runs exist
  /// Time in s from which the reference's pictures are unpredictable (PictureScores::parting_s). Infinity: no
  /// such time; NaN: no pictures.
  double parting_s = 0;
  bool pictures() const { return !std::isnan(parting_s); }
};

/// Evaluates those of `cells` that have the scene, duration and picture sizes of `plan`, and `origin`.
/// `cells` must have the order of SweepFile::cells(). base::Error if the plan's reference is missing or lacks
/// seed 1 or a second seed.
PriceList price_list(const std::vector<StoredCell>& cells, const SweepPlan& plan, const SweepOrigin& origin,
                     double tank_length_m);

/// The Pareto front: indices of the settings whose error is smaller than that of every other setting with an
/// equal or smaller mean time. Fastest first. Settings for which this error is NaN are left out.
std::vector<std::size_t> pareto_front(const std::vector<SettingResult>& settings, SweepError error);

/// Cells with seeds 1 to `seeds` of each setting that is on the Pareto front of some error, in the order of
/// PriceList::settings.
std::vector<SweepCell> more_seeds_of_fronts(const PriceList& list, const SweepPlan& plan, int seeds);

/// A setting in words: n_* and each knob that differs from its usual value: "n_* 512, projections 8".
std::string in_words(const sim::SolverSetting& setting);
/// Words on the reference for this error, such as "counts as converged".
std::string convergence(const PriceList& list, SweepError error);

/// The order in words: "HiRes' order in the time step (1.00, 0.50, 0.25): front 1.02, ...".
std::string in_words(const ObservedOrder& order);
/// A sentence on parting_s: the time at which the pictures of the reference and of its second seed diverge.
/// Requires list.pictures().
std::string parting_in_words(const PriceList& list);

/// The reason why an error of pictures is NaN for all settings.
std::string why_no_price(const PriceList& list);

/// Complete tables for other programs, with machine-readable column names.
figures::TextTable setting_table(const PriceList& list);
figures::TextTable price_table(const PriceList& list);
/// Choice of the errors in a table for people: of the water, or of the pictures.
enum class ErrorPart { Water, Pictures };
figures::TextTable settings_to_read(const PriceList& list, ErrorPart part);
figures::TextTable prices_to_read(const PriceList& list, ErrorPart part);
/// The tables for people as Markdown, with each error's floor and the convergence of the reference.
std::string to_markdown(const PriceList& list);

}  // namespace study
