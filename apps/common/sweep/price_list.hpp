#pragma once
/// What the rows of a sweep say: the error of each setting beside its milliseconds, and what a knob's turn
/// buys.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "apps/common/sweep/picture_errors.hpp"
#include "apps/common/sweep/sweep_file.hpp"
#include "apps/common/text_table.hpp"

namespace apps {

/// Errors that a sweep tells, each in per cent; smaller is better.
enum class SweepError {
  Front,    ///< E1: root mean square over the instants of the front's distance from the reference's, over the
            ///< tank's length
  Centre,   ///< E3: the same of the centre of mass
  Kinetic,  ///< E4: the same of the kinetic energy, over the reference's largest
  Density,  ///< E2: mean over the instants of max(rho / rho_0 - 1, 0), for which no reference is needed
  Picture,  ///< this and all below: PictureError's, NaN where the sweep kept no pictures
  Fovea,
  Salient,
  Ssim,
  Flip,
  Film,
  Flicker
};
/// Those of the water come first.
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

/// Least and largest of the seeds, and their mean.
struct Spread {
  double mean = 0, low = 0, high = 0;
};

/// "1.2 [1.1, 1.3]": mean, least and largest.
std::string in_words(const Spread& spread);

/// A setting with all its seeds.
struct SettingResult {
  SolverSetting setting;
  int seeds = 0;
  double particles = 0, substeps = 0;
  double ms_mean = 0, ms_low_quartile = 0, ms_median = 0, ms_high_quartile = 0, ms_p95 = 0;  ///< whole frames
  double draw_ms_mean = 0;  ///< of it; NaN without pictures
  /// E8: Eq. 11 with the paper's a and b, of the frames as a display shows them that has the setting's rate:
  /// none comes earlier than its period. Frames/s.
  double tau = 0;
  std::array<Spread, sweep_error_count> errors = {};
};

/// What turning one knob away from the start changes.
struct Price {
  sim::MethodKind method{};
  SolverKnob knob{};
  double from = 0, to = 0;
  double ms = 0;                                      ///< change of the mean frame
  double ms_low_quartile = 0, ms_high_quartile = 0;   ///< of the changes of frames at the same instants
  std::array<Spread, sweep_error_count> errors = {};  ///< change; low and high over all pairs of seeds
  /// No more than what frames differ by of themselves: zero lies between the quartiles.
  bool free() const { return ms_low_quartile <= 0 && ms_high_quartile >= 0; }
};

/// How fast HiRes nears itself when it is refined: the slope of log(distance of each run from the next finer
/// one) over log(step), by least squares.
struct ObservedOrder {
  std::string of;                    ///< "particle spacing" or "time step"
  std::vector<double> steps;         ///< over the first one's
  std::array<double, 3> order = {};  ///< of Front, Centre and Kinetic; NaN where two runs are equal
};

struct PriceList {
  SweepOrigin origin;
  std::string scene;
  SweepErrors floor{};  ///< error of a reference moved by an ulp: below it errors say nothing
  /// What twice the projections, substeps and particles change in the reference; empty where not run.
  std::vector<SettingResult> finer = {};
  std::vector<SettingResult> settings = {};
  std::vector<Price> prices = {};
  /// For each error whether all three finer references lie within a third of the smallest error that is
  /// listed above the floor.
  std::array<bool, sweep_error_count> converged{};
  std::vector<ObservedOrder> orders = {};  ///< of what was run
  double parting_s = 0;                    ///< PictureScores'
  bool pictures() const { return !std::isnan(parting_s); }
};

/// Of the cells of one machine, program and scene with this plan's reference. base::Error without the
/// reference and its second seed.
PriceList price_list(const std::vector<StoredCell>& cells, const SweepPlan& plan, const SweepOrigin& origin,
                     double tank_length_m);

/// Settings that no other one beats in both milliseconds (mean) and this error, the fastest first: places in
/// PriceList::settings.
std::vector<std::size_t> pareto_front(const std::vector<SettingResult>& settings, SweepError error);

/// Cells with seeds 1 to `seeds` of each setting that is on the front of any error, in the sweep's order.
std::vector<SweepCell> more_seeds_of_fronts(const PriceList& list, const SweepPlan& plan, int seeds);

/// What tells a setting from its method's usual one: "n_* 512, projections 8".
std::string in_words(const SolverSetting& setting);
/// "counts as converged" and the like, of an error's reference.
std::string convergence(const PriceList& list, SweepError error);

/// "HiRes' order in the time step (1.00, 0.50, 0.25): front 1.02, ...".
std::string in_words(const ObservedOrder& order);
/// A sentence that says when pictures of the reference and of its second seed part; list.pictures().
std::string parting_in_words(const PriceList& list);

/// Why an error of pictures is NaN in all rows.
std::string why_untold(const PriceList& list);

/// For programs.
TextTable setting_table(const PriceList& list);
TextTable price_table(const PriceList& list);
/// For readers: errors of the water or of the pictures.
enum class ErrorPart { Water, Pictures };
TextTable settings_to_read(const PriceList& list, ErrorPart part);
TextTable prices_to_read(const PriceList& list, ErrorPart part);
/// What these show, with what the floor and the finer references say.
std::string to_markdown(const PriceList& list);

}  // namespace apps
