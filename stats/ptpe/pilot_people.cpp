#include "stats/ptpe/pilot_people.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "stats/gsl_errors.hpp"
#include "stats/inference/t_test.hpp"
#include "stats/ptpe/rating_surface.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

using Setting = std::pair<double, double>;

Setting setting_of(const PilotRating& rating) { return {rating.mu, rating.delta}; }

std::map<int, std::vector<const PilotRating*>> by_person(std::span<const PilotRating> ratings) {
  std::map<int, std::vector<const PilotRating*>> out;
  for (const auto& rating : ratings) out[rating.participant].push_back(&rating);
  return out;
}

/// Least squares of the scores on log2 mu, with a separate mean for each standard deviation of the frame
/// rate.
std::optional<PersonSlope> slope_of(const std::vector<const PilotRating*>& ratings) {
  struct Column {
    double n = 0, x = 0, y = 0;
  };
  std::map<double, Column> columns;
  for (const auto* rating : ratings) {
    auto& column = columns[rating->delta];
    column.n += 1;
    column.x += std::log2(rating->mu);
    column.y += rating->score;
  }
  double xx = 0, xy = 0, yy = 0;
  for (const auto* rating : ratings) {
    const auto& column = columns[rating->delta];
    const double x = std::log2(rating->mu) - column.x / column.n, y = rating->score - column.y / column.n;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  PersonSlope out;
  out.participant = ratings.front()->participant;
  out.df = static_cast<int>(ratings.size()) - static_cast<int>(columns.size()) - 1;
  if (out.df < 2 || !(xx > 0)) return std::nullopt;
  out.slope = xy / xx;
  const double rest = yy - xy * out.slope;
  const double error = std::sqrt(std::max(rest, 0.0) / out.df / xx);
  if (error > 1e-12 * (1 + std::abs(out.slope))) {
    use_gsl_codes();
    out.t = out.slope / error;
    out.p = gsl_cdf_tdist_P(out.t, out.df);
  } else {
    out.t = out.slope == 0 ? 0 : std::copysign(std::numeric_limits<double>::infinity(), out.slope);
    out.p = out.slope < 0 ? 0 : 1;
  }
  return out;
}

std::vector<PersonSlope> slopes_of(std::span<const PilotRating> ratings) {
  std::vector<PersonSlope> out;
  for (const auto& [person, own] : by_person(ratings))
    if (auto slope = slope_of(own)) out.push_back(*slope);
  for (auto& one : out) one.reversed = one.p < reverse_level / static_cast<double>(out.size());
  return out;
}

/// True if people rated settings of their own, as under adaptive placement: a setting has fewer scores than
/// half of the people. Means and medians of a setting's scores then say little.
bool settings_differ(std::span<const PilotRating> ratings) {
  std::set<Setting> settings;
  std::set<int> people;
  for (const auto& rating : ratings) {
    settings.insert(setting_of(rating));
    people.insert(rating.participant);
  }
  return 2 * ratings.size() < people.size() * settings.size();
}

/// Each participant's slope over the session of the scores less the mean of the setting's other scores.
std::vector<double> slopes_over_session(std::span<const PilotRating> ratings) {
  std::map<Setting, std::pair<double, double>> settings;  // number and sum of the scores
  for (const auto& rating : ratings) {
    auto& [n, sum] = settings[setting_of(rating)];
    n += 1;
    sum += rating.score;
  }
  const auto sessions = sessions_of(ratings);
  std::vector<double> slopes;
  for (const auto& [person, own] : by_person(ratings)) {
    // Position in the session; score minus the mean of the setting's other scores.
    std::vector<std::array<double, 2>> points;
    for (const auto* rating : own) {
      const auto& [n, sum] = settings[setting_of(*rating)];
      if (n < 2) continue;
      points.push_back(
          {place_of(*rating, sessions.at(person)), rating->score - (sum - rating->score) / (n - 1)});
    }
    double x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& point : points) {
      x += point[0] / static_cast<double>(points.size());
      y += point[1] / static_cast<double>(points.size());
    }
    for (const auto& point : points) {
      xx += (point[0] - x) * (point[0] - x);
      xy += (point[0] - x) * (point[1] - y);
    }
    if (xx > 0) slopes.push_back(xy / xx);
  }
  return slopes;
}

Result<SessionDrift> drift_of(std::span<const PilotRating> ratings, double confidence) {
  if (std::any_of(ratings.begin(), ratings.end(), [](const auto& rating) { return rating.position < 0; }))
    return Refusal{"the positions of the trials are not known"};
  const auto changes = settings_differ(ratings) ? surface_changes(ratings) : slopes_over_session(ratings);
  const auto test = t_test_one(changes, {.confidence = confidence, .effect_intervals = false});
  if (!test) return Refusal{test.reason()};
  return SessionDrift{test->mean, test->t, test->p, static_cast<int>(test->df), test->ci};
}

/// The expected score of each answer without lapses: the setting's median score plus the participant's median
/// distance from such medians. Where settings_differ(), surface_scores() stand in for the medians.
std::vector<double> expected_scores(std::span<const PilotRating> ratings, bool by_surface) {
  std::vector<double> out;
  if (by_surface) {
    out = surface_scores(ratings);
  } else {
    std::map<Setting, std::vector<double>> settings;
    for (const auto& rating : ratings) settings[setting_of(rating)].push_back(rating.score);
    for (const auto& rating : ratings) out.push_back(median_of(settings[setting_of(rating)]));
  }
  std::map<int, std::vector<double>> distances;
  for (std::size_t i = 0; i < ratings.size(); ++i)
    distances[ratings[i].participant].push_back(ratings[i].score - out[i]);
  std::map<int, double> own;
  for (const auto& [person, list] : distances) own[person] = median_of(list);
  for (std::size_t i = 0; i < ratings.size(); ++i) out[i] += own[ratings[i].participant];
  return out;
}

/// Standard deviation of answers about their expected scores. Only expected scores in the middle half of the
/// range of scores given count, since answers near its ends scatter less. Residuals are clipped at `clip`, so
/// that lapses hardly increase the standard deviation.
Result<double> spread_about(std::span<const PilotRating> ratings, const std::vector<double>& expected,
                            double lowest, double highest) {
  constexpr double clip = 2.5;
  const double quarter = (highest - lowest) / 4;
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < ratings.size(); ++i) {
    if (expected[i] < lowest + quarter || expected[i] > highest - quarter) continue;
    sum += std::min(clip, std::abs(ratings[i].score - expected[i]));
    n += 1;
  }
  const std::string inner = "in the middle half of the scores given";
  if (n == 0) return Refusal{"no expected score lies " + inner};
  if (sum == 0) return Refusal{"no answer whose expected score lies " + inner + " departs from it"};
  return std::sqrt(M_PI / 2) * sum / n;
}

/// The answers of all but reverse coders, with their expected scores and the standard deviation about them.
struct Expected {
  std::vector<PilotRating> ratings;
  std::vector<double> scores;
  double sd = 0, lowest = 0, highest = 0;
};

Result<Expected> expected_of(std::span<const PilotRating> all, const std::vector<PersonSlope>& slopes,
                             bool by_surface) {
  std::set<int> reversed;
  for (const auto& one : slopes)
    if (one.reversed) reversed.insert(one.participant);
  Expected out;
  for (const auto& rating : all)
    if (!reversed.contains(rating.participant)) out.ratings.push_back(rating);
  if (out.ratings.empty()) return Refusal{"every participant is a reverse coder"};
  out.lowest = out.highest = out.ratings.front().score;
  for (const auto& rating : out.ratings) {
    out.lowest = std::min(out.lowest, rating.score);
    out.highest = std::max(out.highest, rating.score);
  }
  if (out.highest == out.lowest) return Refusal{"all answers are equal"};
  out.scores = expected_scores(out.ratings, by_surface);
  const auto sd = spread_about(out.ratings, out.scores, out.lowest, out.highest);
  if (!sd) return Refusal{sd.reason()};
  out.sd = *sd;
  return out;
}

Result<LapseCount> lapses_of(const Expected& expected) {
  LapseCount out;
  out.lowest = expected.lowest;
  for (std::size_t i = 0; i < expected.ratings.size(); ++i) {
    const double chance = normal_probability((out.lowest + 0.5 - expected.scores[i]) / expected.sd);
    if (chance >= lapse_tail) continue;
    ++out.at_risk;
    out.lapsed += expected.ratings[i].score == out.lowest;
    out.expected += chance;
  }
  if (out.at_risk == 0) return Refusal{"the lowest score is improbable at no setting"};
  use_gsl_codes();
  if (out.lapsed > 0) out.p = gsl_cdf_poisson_Q(static_cast<unsigned>(out.lapsed - 1), out.expected);
  out.rate = std::max(0.0, (out.lapsed - out.expected) / (out.at_risk - out.expected));
  return out;
}

FarAnswers far_of(const Expected& expected) {
  FarAnswers out;
  for (std::size_t i = 0; i < expected.ratings.size(); ++i) {
    const double middle = expected.scores[i], given = expected.ratings[i].score;
    ++out.answers;
    // On each side the chance of the nearest score from which on scores are improbable.
    const auto side = [&](double first, double step) {
      for (double score = first; score >= expected.lowest && score <= expected.highest; score += step) {
        const double chance = normal_probability((step * (middle - score) + 0.5) / expected.sd);
        if (chance >= lapse_tail) continue;
        out.expected += chance;
        out.far += step * (given - score) >= 0;
        return;
      }
    };
    side(std::ceil(middle), 1);
    side(std::floor(middle), -1);
  }
  use_gsl_codes();
  if (out.far > 0) out.p = gsl_cdf_poisson_Q(static_cast<unsigned>(out.far - 1), out.expected);
  return out;
}

}  // namespace

bool SessionDrift::found() const { return p < drift_level; }
bool LapseCount::found() const { return p < lapse_level; }
bool FarAnswers::found() const { return p < far_level; }

int PilotPeople::reversed() const {
  return static_cast<int>(
      std::count_if(slopes.begin(), slopes.end(), [](const auto& one) { return one.reversed; }));
}

PilotPeople pilot_people(std::span<const PilotRating> ratings, double confidence) {
  PilotPeople out;
  if (ratings.empty()) {
    out.drift = Refusal{"no ratings"};
    out.lapses = Refusal{"no ratings"};
    out.far = Refusal{"no ratings"};
    return out;
  }
  out.slopes = slopes_of(ratings);
  out.drift = drift_of(ratings, confidence);
  const auto expected = expected_of(ratings, out.slopes, settings_differ(ratings));
  out.lapses = expected ? lapses_of(*expected) : Refusal{expected.reason()};
  const auto smooth = expected_of(ratings, out.slopes, true);
  out.far = smooth ? Result<FarAnswers>(far_of(*smooth)) : Refusal{smooth.reason()};
  return out;
}

std::vector<PilotRating> apply_rules(std::span<const PilotRating> ratings, const PilotPeople& people,
                                     const PilotRules& rules) {
  std::set<int> reversed;
  for (const auto& one : people.slopes)
    if (one.reversed) reversed.insert(one.participant);
  const auto sessions = sessions_of(ratings);
  const double rate = rules.model_lapses && people.lapses ? people.lapses->rate : 0;
  std::vector<PilotRating> out;
  for (auto rating : ratings) {
    if (rules.exclude_reverse_coders && reversed.contains(rating.participant)) continue;
    if (rules.model_drift && people.drift)
      rating.score -= people.drift->change * place_of(rating, sessions.at(rating.participant));
    if (rate > 0) rating.score = (rating.score - rate * people.lapses->lowest) / (1 - rate);
    out.push_back(rating);
  }
  return out;
}

}  // namespace stats
