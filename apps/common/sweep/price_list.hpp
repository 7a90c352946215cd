#pragma once
/// What the rows of a sweep say: the error of each setting beside its milliseconds, and what a knob's turn
/// buys.

#include <array>
#include <string>
#include <vector>

#include "apps/common/sweep/sweep_file.hpp"
#include "apps/common/text_table.hpp"

namespace apps {

/// Errors that a sweep tells, each in per cent; smaller is better.
enum class SweepError {
  Front,    ///< E1: root mean square over the instants of the front's distance from the reference's, over the
            ///< tank's length
  Centre,   ///< E3: the same of the centre of mass
  Kinetic,  ///< E4: the same of the kinetic energy, over the reference's largest
  Density   ///< E2: mean over the instants of max(rho / rho_0 - 1, 0), for which no reference is needed
};
inline constexpr std::size_t sweep_error_count = 4;
inline constexpr std::array<const char*, sweep_error_count> sweep_error_columns{"front_pct", "centre_pct",
                                                                                "kinetic_pct", "density_pct"};
inline constexpr std::array<const char*, sweep_error_count> sweep_error_words{"front", "centre of mass",
                                                                              "kinetic energy", "density"};
using SweepErrors = std::array<double, sweep_error_count>;

/// base::Error unless both were sampled at the same instants.
SweepErrors errors_of(const CellRun& run, const CellRun& reference, double tank_length_m);

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

/// For programs.
TextTable setting_table(const PriceList& list);
TextTable price_table(const PriceList& list);
/// For readers.
TextTable settings_to_read(const PriceList& list);
TextTable prices_to_read(const PriceList& list);
/// Both of these, with what the floor and the finer references say.
std::string to_markdown(const PriceList& list);

}  // namespace apps
