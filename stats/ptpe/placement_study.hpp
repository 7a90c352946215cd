#pragma once
/// Simulated studies that compare adaptive placement with a fixed list of settings.

#include <cstdint>
#include <vector>

#include "stats/ptpe/placement.hpp"

namespace stats {

/// How the simulated people differ from the model that the placement assumes; mu and delta are the mean and
/// the standard deviation of the frame rate shown. In every case, each person's scores are also shifted by a
/// normal amount with an sd of 0.5 scores.
enum class PlacementTruth {
  Model,   ///< as assumed: score = level + slope (mu - a exp(b delta)) + noise, rounded; all people have the
           ///< same a and b
  Linear,  ///< the contour is a straight line that meets a exp(b delta) at delta = 0 and 20 frames/s
  Hinge,   ///< the contour is a up to delta = 10 and then a straight line that meets a exp(b delta) at 20
  Lapses,  ///< a tenth of the ratings are random scores
  LowestLapses,  ///< a tenth of the ratings are the lowest score
  Drift          ///< ratings fall steadily, by about one score over the session
};

/// The case in a word or two: "model", "linear", "hinge", "lapses", "lowest lapses", "drift".
const char* placement_truth_word(PlacementTruth truth);

struct PlacementStudy {
  double a = 24, b = 0.02;  ///< true contour, frames/s and s/frame
  PlacementTruth truth = PlacementTruth::Model;
  int people = 16;
  int trials = 10;  ///< trials of each person; without effect on fixed settings, which are all shown once
  bool adaptive = true;
  PlacementRules rules = {};  ///< rules of an adaptive study; trials and between follow from `trials`
};

/// Averages over simulated studies. Each study is analysed by estimate_direct() with the jackknife over
/// people.
struct PlacementSummary {
  int studies = 0, fitted = 0;  ///< fitted: studies with an interval; only these enter the fields below
  double a_width = 0;           ///< mean width of the interval of ln a
  double b_width = 0;           ///< mean width of the interval of b, s/frame
  double a_covered = 0, b_covered = 0;  ///< shares of the intervals that hold the truth
  double a_bias = 0;                    ///< mean error of a as a share of a
  double form_rejected = 0;             ///< share of studies in which the form test rejects an exponential
  double drift_found = 0;   ///< share of studies in which SessionDrift::found() (pilot_people.hpp)
  double lapses_found = 0;  ///< share of studies in which LapseCount::found() (pilot_people.hpp)
  double far_found = 0;     ///< share of studies in which FarAnswers::found() (pilot_people.hpp)
};

/// `fixed`: the settings of studies that are not adaptive; `candidates`: those that an adaptive study may
/// show. Equal seeds give equal summaries, whatever the number of threads. Under Linear the covered shares
/// are of a and b of the exponential through the line's ends.
PlacementSummary simulate_placement(const PlacementStudy& study, const std::vector<PlacementSetting>& fixed,
                                    const std::vector<PlacementSetting>& candidates, int studies,
                                    std::uint64_t seed);

}  // namespace stats
