#include "stats/ptpe/placement_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/pilot.hpp"
#include "stats/ptpe/pilot_people.hpp"

namespace stats {
namespace {

constexpr std::array placement_truth_words{"model", "linear", "hinge", "lapses", "lowest lapses", "drift"};
constexpr double true_slope = 0.14;     // scores per frame/s
constexpr double true_person_sd = 0.5;  // scores
constexpr double lapse_share = 0.1;
/// Standard deviation in frames/s: the straight contour and the exponential meet here and at 0.
constexpr double line_end = 20;
/// The hinge begins to rise here, frames/s.
constexpr double hinge_begin = 10;
constexpr int lowest_score = 1, highest_score = 7;
constexpr double middle_score = 4;

/// One simulated person.
class Rater {
 public:
  Rater(const PlacementStudy& study, std::uint64_t seed) : study_(study), random_(seed) {
    person_ = true_person_sd * normal_(random_);
  }

  int rate(const PlacementSetting& setting, double progress) {
    if (study_.truth == PlacementTruth::LowestLapses && uniform_(random_) < lapse_share) return lowest_score;
    if (study_.truth == PlacementTruth::Lapses && uniform_(random_) < lapse_share)
      return lowest_score + static_cast<int>(uniform_(random_) * (highest_score - lowest_score + 1));
    const double drift = study_.truth == PlacementTruth::Drift ? 0.5 - progress : 0;
    const double score = middle_score + true_slope * (setting.mu - contour(setting.delta)) + person_ + drift +
                         normal_(random_);
    return std::clamp(static_cast<int>(std::lround(score)), lowest_score, highest_score);
  }

 private:
  double contour(double delta) const {
    const double rise = study_.a * std::expm1(study_.b * line_end);  // of the contour from 0 to line_end
    if (study_.truth == PlacementTruth::Linear) return study_.a + rise * delta / line_end;
    if (study_.truth == PlacementTruth::Hinge)
      return study_.a + rise * std::max(0.0, delta - hinge_begin) / (line_end - hinge_begin);
    return study_.a * std::exp(study_.b * delta);
  }

  const PlacementStudy& study_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  double person_ = 0;
};

struct OneStudy {
  bool fitted = false, form_rejected = false, drift_found = false, lapses_found = false, far_found = false;
  double log_a_width = 0, b_width = 0, a = 0;
  bool a_covered = false, b_covered = false;
};

OneStudy run_study(const PlacementStudy& study, const std::vector<PlacementSetting>& settings,
                   const Placement& fresh, std::uint64_t seed) {
  std::vector<PilotRating> ratings;
  std::mt19937_64 orders(seed);
  Placement known = fresh;  // what the ratings of all people so far say
  for (int person = 0; person < study.people; ++person) {
    Rater rater(study, seed + static_cast<std::uint64_t>(person));
    Placement placement = known;
    placement.set_person(person);
    std::vector<int> order(settings.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), orders);
    const int trials = study.adaptive ? study.trials : static_cast<int>(settings.size());
    for (int trial = 0; trial < trials; ++trial) {
      const int index = study.adaptive ? placement.next() : order[static_cast<std::size_t>(trial)];
      const PlacementSetting& setting = settings[static_cast<std::size_t>(index)];
      const int score = rater.rate(setting, static_cast<double>(trial) / trials);
      if (study.adaptive) {
        placement.add(index, score);
        known.learn(index, score);
      }
      ratings.push_back({person, setting.mu, setting.delta, setting.mu, setting.mu, setting.delta,
                         static_cast<double>(score), trial});
    }
  }
  const auto observations = PilotTable(ratings).observations(PilotMean::Harmonic);
  BootstrapOptions none;
  none.resamples = 0;
  const DirectEstimate estimate = estimate_direct(observations, middle_score, none);
  const PilotPeople people = pilot_people(ratings, none.confidence);
  OneStudy out;
  out.drift_found = people.drift && people.drift->found();
  out.lapses_found = people.lapses && people.lapses->found();
  out.far_found = people.far && people.far->found();
  out.form_rejected = estimate.form && estimate.form->rejected();
  if (!estimate.jackknife) return out;
  const CurveSpread& spread = *estimate.jackknife;
  out.fitted = true;
  out.a = spread.curve.a();
  out.log_a_width = std::log(spread.a_ci[1] / spread.a_ci[0]);
  out.b_width = spread.b_ci[1] - spread.b_ci[0];
  out.a_covered = spread.a_ci[0] <= study.a && study.a <= spread.a_ci[1];
  out.b_covered = spread.b_ci[0] <= study.b && study.b <= spread.b_ci[1];
  return out;
}

}  // namespace

const char* placement_truth_word(PlacementTruth truth) {
  return placement_truth_words[static_cast<std::size_t>(truth)];
}

PlacementSummary simulate_placement(const PlacementStudy& study, const std::vector<PlacementSetting>& fixed,
                                    const std::vector<PlacementSetting>& candidates, int studies,
                                    std::uint64_t seed) {
  const auto& settings = study.adaptive ? candidates : fixed;
  PlacementRules rules = study.rules;
  rules.trials = study.adaptive ? study.trials : static_cast<int>(settings.size());
  rules.between = usual_between(rules.trials);
  const Placement fresh(settings, placement_prior(settings), rules);
  std::vector<OneStudy> all(static_cast<std::size_t>(studies));
#pragma omp parallel for schedule(dynamic)
  for (int i = 0; i < studies; ++i)
    all[static_cast<std::size_t>(i)] =
        run_study(study, settings, fresh, seed + 1000 * static_cast<std::uint64_t>(i));
  PlacementSummary out;
  out.studies = studies;
  for (const OneStudy& one : all) {
    out.form_rejected += one.form_rejected;
    out.drift_found += one.drift_found;
    out.lapses_found += one.lapses_found;
    out.far_found += one.far_found;
    if (!one.fitted) continue;
    ++out.fitted;
    out.a_width += one.log_a_width;
    out.b_width += one.b_width;
    out.a_covered += one.a_covered;
    out.b_covered += one.b_covered;
    out.a_bias += one.a / study.a - 1;
  }
  for (double* sum : {&out.a_width, &out.b_width, &out.a_covered, &out.b_covered, &out.a_bias})
    *sum /= std::max(1, out.fitted);
  for (double* sum : {&out.form_rejected, &out.drift_found, &out.lapses_found, &out.far_found})
    *sum /= std::max(1, studies);
  return out;
}

}  // namespace stats
