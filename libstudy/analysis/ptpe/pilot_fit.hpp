#pragma once
/// Fits a pilot's ratings and makes the contents of its files fit.json and the solver's file.

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
  std::string code;  ///< in snake_case; does not change between versions
  std::string text;
};

/// All estimates at one level of the scale. The predictor is either the harmonic or the arithmetic mean of
/// the realised frame rate. `ordinal` and `band` are computed for the harmonic mean only.
struct LevelFit {
  stats::DirectEstimate direct;  ///< main estimate: the curve is fitted to the ratings
  stats::PilotEstimate contour;  ///< paper's estimate: the curve is fitted to the contour of the mean ratings
  stats::OrdinalPilotEstimate ordinal;
  /// Confidence bands of mu(delta) for the solver's file (scale_end_fit.hpp).
  stats::Result<stats::CurveSpread> band = stats::Refusal{"not computed"};
};

struct MainFit {
  double a = 0, b = 0;
};
struct MainSpread {
  /// Intervals of a and b. If spans_contour is true, each covers the direct estimate's interval and the
  /// contour estimate's (stats/ptpe/solver_interval.hpp).
  std::array<double, 2> a_ci{}, b_ci{};
  double a_se = 0, b_se = 0;  ///< standard errors of the direct estimate
  bool spans_contour = false;
};
/// The estimate that is written into the solver's file.
struct MainEstimate {
  stats::Result<MainFit> fit;
  stats::Result<MainSpread> spread;
};

/// A pilot's estimates at `level`, with the harmonic and with the arithmetic mean of the realised frame rate.
/// On the paper's scale of 1 to 7 the pilot is also fitted at the paper's levels, 4.0 and 5.0. The ordinal
/// estimate uses only the harmonic mean.
struct PilotFit {
  TaskData data;
  double level = 4;
  stats::BootstrapOptions bootstrap;
  int participants = 0;
  std::size_t settings = 0;                 ///< number of settings of the frame rate with a rating
  stats::ScoreGrid grid;                    ///< mean scores, by the harmonic mean of the realised frame rate
  std::vector<std::vector<double>> scores;  ///< for each node of the grid, the mean score of each participant
  std::vector<double> deltas;  ///< nominal standard deviations of the frame rate in frames/s, ascending
  std::map<double, LevelFit> harmonic, arithmetic;  ///< estimates by level, for the two kinds of mean
  stats::PilotPeople people;  ///< tests of how participants used the scale, on all analysed ratings before
                              ///< `rules` are applied
  stats::PilotRules rules;    ///< the plan's rules for reverse coders, drift and lapses; `data` holds the
                              ///< ratings after these rules
  std::vector<FitFlag> flags;
  /// The reason why there is no usable fit, for example no estimate or a level outside the scale; empty if
  /// there is one.
  std::string reason;
  /// Reasons why a solver must not use the fit although `reason` is empty, for example that the scores do not
  /// rise with the frame rate.
  std::vector<stats::PilotDoubt> doubts;

  bool ok() const { return reason.empty(); }
  bool level_within_scale() const;
  const LevelFit& chosen() const { return harmonic.at(level); }
  /// The direct estimate at `level`. Its predictor is the harmonic mean, since mu in the solver is a harmonic
  /// mean.
  MainEstimate main() const;
  /// Largest half width of the direct curve's band, as a share of mu(delta). Only deltas are used at which
  /// mu(delta) lies within the mean frame rates shown. Requires ok().
  double relative_half_width() const;
};

/// The resampled curves of each bootstrap of a fit: for each level that is fitted, in ascending order, for
/// the harmonic and then the arithmetic mean, those of the direct and then of the contour estimate. The
/// curves of an estimate without a fit are empty.
using FitResamples = std::vector<stats::ResampledCurves>;

/// Some of the resamples of fit_pilot() with the same arguments. bootstrap.resamples is not used. Each
/// resample depends on its number and on the seed only, so that parts of the resamples make up the whole.
FitResamples resample_fit(const TaskData& data, double level, const stats::BootstrapOptions& bootstrap,
                          const stats::PilotRules& rules, stats::ResampleRange range);

/// Fits the pilot at the score `level`, which must be finite. A level outside the rating scale gives a fit
/// with ok() = false. `drawn`: all resamples, if resample_fit() has computed them; none: they are computed
/// here.
PilotFit fit_pilot(TaskData data, double level, const stats::BootstrapOptions& bootstrap,
                   const stats::PilotRules& rules = {}, const FitResamples* drawn = nullptr);

/// The content of fit.json if the database has no data to fit. It holds the reason.
base::Json failed_fit_json(std::optional<double> level, const std::string& reason);
/// The content of fit.json: every number of the fit. An undefined value is null and has its reason beside it.
base::Json fit_json(const PilotFit& fit);
/// The fit as the file of a and b that the solver reads. Requires fit.ok().
sim::PtpeFile ptpe_file(const PilotFit& fit);

}  // namespace study
