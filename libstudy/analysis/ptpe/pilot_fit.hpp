#pragma once
/// The fit of a pilot, from its ratings to the contents of its files.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libsim/ptpe/ptpe_file.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/base/json.hpp"
#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/ordinal_pilot.hpp"
#include "stats/ptpe/pilot.hpp"
#include "stats/ptpe/pilot_doubts.hpp"
#include "stats/ptpe/pilot_people.hpp"
#include "stats/ptpe/scale_end_fit.hpp"

namespace study {

/// A remark that a reader of the fit needs to know.
struct FitFlag {
  std::string code;  ///< stable, snake_case
  std::string text;
};

/// All estimates at one level, with one of the realised means as predictor.
struct LevelFit {
  stats::DirectEstimate direct;  ///< the main one
  stats::PilotEstimate contour;  ///< the paper's
  stats::OrdinalPilotEstimate ordinal;
  /// The bands of mu(delta) for the solver's file (scale_end_fit.hpp); with the harmonic mean only.
  stats::Result<stats::CurveSpread> band = stats::Refusal{"not computed"};
};

struct MainFit {
  double a = 0, b = 0;
};
struct MainSpread {
  std::array<double, 2> a_ci{}, b_ci{};  ///< span the contour's intervals too
                                         ///< (stats/ptpe/solver_interval.hpp)
  double a_se = 0, b_se = 0;             ///< of the direct estimate
  bool spans_contour = false;
};
/// The estimate for the solver.
struct MainEstimate {
  stats::Result<MainFit> fit;
  stats::Result<MainSpread> spread;
};

/// The estimates at the level of the study, with the harmonic and with the arithmetic realised mean; on the
/// paper's scale of 1 to 7 also at the paper's two levels, 4.0 and 5.0. The ordinal estimate uses only the
/// harmonic mean.
struct PilotFit {
  TaskData data;
  double level = 4;
  stats::BootstrapOptions bootstrap;
  int participants = 0;
  std::size_t settings = 0;
  stats::ScoreGrid grid;                    ///< harmonic
  std::vector<std::vector<double>> scores;  ///< for each node of the grid: one mean for each participant
  std::vector<double> deltas;               ///< nominal, ascending
  std::map<double, LevelFit> harmonic, arithmetic;  ///< by level
  stats::PilotPeople people;                        ///< from all analysed ratings, before the rules
  stats::PilotRules rules;  ///< the plan's rules for it; `data` holds the ratings after them
  std::vector<FitFlag> flags;
  std::string reason;                     ///< why there is no usable fit; empty if there is one
  std::vector<stats::PilotDoubt> doubts;  ///< why the fit must not be used by a solver

  bool ok() const { return reason.empty(); }
  bool level_within_scale() const;
  const LevelFit& chosen() const { return harmonic.at(level); }
  /// The direct estimate at `level`, with the harmonic mean as in the solver's mu.
  MainEstimate main() const;
  /// Largest half width of the direct curve's 95 % band, as a share of mu(delta), over the deltas shown at
  /// which the curve is in reach; beyond them it is extrapolated and flagged. Requires ok().
  double relative_half_width() const;
};

/// `level` must be finite; outside the rating scale there is no fit.
PilotFit fit_pilot(TaskData data, double level, const stats::BootstrapOptions& bootstrap,
                   const stats::PilotRules& rules = {});

/// fit.json for a database without usable data: only the reason is known.
base::Json failed_fit_json(std::optional<double> level, const std::string& reason);
/// Every number of the fit, for fit.json. It has no NaN: undefined values are null, with the reason beside
/// them.
base::Json fit_json(const PilotFit& fit);
/// The solver's file. Requires fit.ok().
sim::PtpeFile ptpe_file(const PilotFit& fit);

}  // namespace study
