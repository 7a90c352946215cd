#pragma once
/// Timings to show next: those at which rival models predict the most different answers.

#include <string>
#include <vector>

#include "libstudy/analysis/rivals/rival_data.hpp"
#include "stats/ordinal/rival_fit.hpp"

namespace study {

/// A fitted model, as it predicts the answers of a new person.
struct FittedModel {
  const TimingModel* model = nullptr;
  const stats::RivalFitter* fitter = nullptr;
  const stats::RivalFit* fit = nullptr;
};

struct Proposal {
  std::string words;   ///< profile_text() of the timing; with its order if that matters
  std::string timing;  ///< the line of a [[factor.level]], "timing = {...}"
  std::string pacing;  ///< the lines of [pacing] that it needs; empty: those of the protocol
  /// Jensen-Shannon divergence of the models' predictions: what one answer says about which of them is true,
  /// if all are equally likely before, nats.
  double information = 0;
  std::vector<double> scores;  ///< mean score that each model predicts
};

struct Proposals {
  std::vector<Proposal> best;  ///< the most informative first; at most two of one profile
  int tried = 0,
      beyond = 0;  ///< timings tried; those left out because a predictor lies beyond what was shown
};

/// Tries hitches, floors, traces of two alternating rates, other moments and, if a model depends on the order
/// of frames, correlated ones. A timing is left out where a predictor of a model lies beyond its values
/// shown, for there a model would be extrapolated. Trials last as long as those shown.
Proposals propose_timings(const RivalData& data, const std::vector<FittedModel>& models);

}  // namespace study
