#include "stats/ptpe/scale_end_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stats/ptpe/term_sums.hpp"
#include "stats/quantiles.hpp"
#include "stats/root.hpp"

namespace stats {

namespace {

constexpr std::size_t parameters = 5;
using FiveValues = std::array<double, parameters>;

/// Expected rating S(x): the mean of x plus a normal error, rounded to a whole score and clamped to the
/// scale.
struct EndScale {
  ScaleEnds ends;
  double sd = 1;
  double x_of_level = 4;

  double step_z(double x, double score) const { return (x - score - 0.5) / sd; }
  double mean(double x) const {
    double sum = ends.lowest;
    for (double score = ends.lowest; score < ends.highest; ++score)
      sum += normal_probability(step_z(x, score));
    return sum;
  }
  double slope(double x) const {
    double sum = 0;
    for (double score = ends.lowest; score < ends.highest; ++score) {
      const double z = step_z(x, score);
      sum += std::exp(-z * z / 2);
    }
    return sum / (sd * std::sqrt(2 * std::numbers::pi));
  }
};

/// The ratings at one realised mean mu and standard deviation delta of the frame rate.
struct Group {
  double root = 0;  ///< 2 sqrt(mu / M), where M is the geometric mean of the frame rates
  double e = 0;     ///< delta minus its mean, in units of delta_unit
  double n = 0, sum = 0;
};

struct Centre {
  double log_mu = 0, delta = 0;
};

Centre centre_of(std::span<const PilotObservation> observations) {
  Centre out;
  const double n = static_cast<double>(observations.size());
  for (const auto& o : observations) {
    out.log_mu += std::log(o.mu) / n;
    out.delta += o.delta / n;
  }
  return out;
}

/// Groups without participant `left_out`; -1: with all participants.
std::vector<Group> groups_of(std::span<const PilotObservation> observations, const Centre& centre,
                             int left_out) {
  std::map<std::pair<double, double>, Group> groups;
  for (const auto& o : observations) {
    if (o.participant == left_out) continue;
    Group& group = groups[{o.mu, o.delta}];
    group.root = 2 * std::exp((std::log(o.mu) - centre.log_mu) / 2);
    group.e = (o.delta - centre.delta) / delta_unit;
    group.n += 1;
    group.sum += o.score;
  }
  std::vector<Group> out;
  for (const auto& [place, group] : groups) out.push_back(group);
  return out;
}

/// Parameters of the model. On the threshold curve, log mu minus its mean over the ratings is alpha + beta e.
struct CurvePlace {
  double alpha = 0, beta = 0, k = 0, m = 0, q = 0;

  CurvePlace moved(const FiveValues& step) const {
    return {alpha + step[0], beta + step[1], k + step[2], m + step[3], q + step[4]};
  }
  /// Predicted mean score of a group, and its derivatives with respect to the parameters.
  double predict(const Group& group, const EndScale& scale, FiveValues* slopes = nullptr) const {
    const double root = 2 * std::exp((alpha + beta * group.e) / 2), u = group.root - root;
    const double x = scale.x_of_level + u * (k + m * group.e + q * u);
    if (slopes) {
      const double by_x = scale.slope(x), by_alpha = -by_x * (k + m * group.e + 2 * q * u) * root / 2;
      *slopes = {by_alpha, by_alpha * group.e, by_x * u, by_x * u * group.e, by_x * u * u};
    }
    return scale.mean(x);
  }
  bool finite() const {
    return std::isfinite(alpha) && std::isfinite(beta) && std::isfinite(k) && std::isfinite(m) &&
           std::isfinite(q);
  }
};

/// Sum of squared deviations of the group means from the predictions, weighted by the groups' sizes. The
/// squares within groups do not depend on the parameters.
double squares(const std::vector<Group>& groups, const EndScale& scale, const CurvePlace& at) {
  double sum = 0;
  for (const Group& group : groups) {
    const double off = group.sum / group.n - at.predict(group, scale);
    sum += group.n * off * off;
  }
  return sum;
}

struct Normal {
  std::array<double, parameters * parameters> matrix{};
  FiveValues right{};
};

Normal normal_equations(const std::vector<Group>& groups, const EndScale& scale, const CurvePlace& at) {
  Normal out;
  for (const Group& group : groups) {
    FiveValues slopes;
    const double off = group.sum / group.n - at.predict(group, scale, &slopes);
    for (std::size_t i = 0; i < parameters; ++i) {
      out.right[i] += group.n * slopes[i] * off;
      for (std::size_t j = 0; j < parameters; ++j)
        out.matrix[i * parameters + j] += group.n * slopes[i] * slopes[j];
    }
  }
  return out;
}

/// Damped Gauss-Newton steps (Marquardt 1963) until the steps vanish. Empty if they do not within 200
/// iterations, or if no step improves the fit and the parameters are not determined there.
std::optional<CurvePlace> descend(const std::vector<Group>& groups, const EndScale& scale, CurvePlace at) {
  double value = squares(groups, scale, at), damping = 1e-3;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Normal normal = normal_equations(groups, scale, at);
    bool moved = false;
    for (; damping < 1e12 && !moved; damping *= 10) {
      auto damped = normal.matrix;
      for (std::size_t i = 0; i < parameters; ++i) damped[i * (parameters + 1)] *= 1 + damping;
      const auto step = solve_positive<parameters>(damped, normal.right);
      if (!step) continue;
      const CurvePlace next = at.moved(*step);
      double length = 0;
      for (const double part : *step) length = std::max(length, std::abs(part));
      if (length < 1e-9) return at;
      const double there = squares(groups, scale, next);
      if (!(there < value)) continue;
      at = next;
      value = there;
      damping = std::max(damping / 100, 1e-12);
      moved = true;
    }
    // No step is better: this is a minimum up to rounding if the matrix is invertible.
    if (!moved)
      return solve_positive<parameters>(normal.matrix, normal.right) ? std::optional(at) : std::nullopt;
  }
  return std::nullopt;
}

/// The standard deviation of a rating about its setting's mean, without the part that is due to rounding to
/// whole scores. Counts only settings whose mean lies in the middle half of the scale. The squared result is
/// at least 0.1.
Result<double> error_sd(std::span<const PilotObservation> observations, const ScaleEnds& ends) {
  struct Setting {
    double n = 0, sum = 0, squares = 0;
  };
  std::map<std::pair<double, double>, Setting> settings;
  for (const auto& o : observations) {
    Setting& one = settings[{o.nominal_mu, o.nominal_delta}];
    one.n += 1;
    one.sum += o.score;
    one.squares += o.score * o.score;
  }
  const double quarter = (ends.highest - ends.lowest) / 4;
  double sum = 0, df = 0;
  for (const auto& [place, one] : settings) {
    const double mean = one.sum / one.n;
    if (mean < ends.lowest + quarter || mean > ends.highest - quarter) continue;
    sum += one.squares - one.sum * mean;
    df += one.n - 1;
  }
  constexpr double rounding = 1.0 / 12, least = 0.1;
  if (!(df > 0 && sum > 1e-12))
    return Refusal{"no setting with a mean score in the middle of the scale was rated differently"};
  return std::sqrt(std::max(sum / df - rounding, least));
}

Result<CurvePlace> fit(const std::vector<Group>& groups, const EndScale& scale, const CurvePlace& from) {
  const auto end = descend(groups, scale, from);
  if (!end || !end->finite()) return Refusal{"the search for the least squares did not end"};
  for (const Group& group : groups)
    if (!(end->k + end->m * group.e > 0))
      return Refusal{"the scores do not rise with the frame rate all along the curve"};
  return *end;
}

Curve curve_of(const CurvePlace& at, const Centre& centre) {
  Curve out;
  out.b = at.beta / delta_unit;
  out.log_a = at.alpha + centre.log_mu - out.b * centre.delta;
  return out;
}

CurvePlace start_of(const DirectFit& direct, const Centre& centre) {
  return {direct.curve.log_a + direct.curve.b * centre.delta - centre.log_mu, direct.curve.b * delta_unit,
          direct.k + direct.m * centre.delta, direct.m * delta_unit, 0};
}

}  // namespace

Result<CurveSpread> scale_end_curve(std::span<const PilotObservation> observations,
                                    const DirectEstimate& direct, double level, const ScaleEnds& ends) {
  if (!direct.fit) return Refusal{direct.fit.reason()};
  if (!(level > ends.lowest && level < ends.highest)) return Refusal{"the level lies outside the scale"};
  std::vector<PilotObservation> kept;
  int people = 0;
  for (const auto& o : observations) {
    people = std::max(people, o.participant + 1);
    if (std::count(direct.out_of_reach.begin(), direct.out_of_reach.end(), o.nominal_delta) == 0)
      kept.push_back(o);
  }
  if (people < least_participants)
    return Refusal{"a band over participants needs at least " + std::to_string(least_participants) +
                   " of them, not " + std::to_string(people)};
  const auto sd = error_sd(kept, ends);
  if (!sd) return Refusal{sd.reason()};
  EndScale scale{ends, *sd};
  const double far = 1 + 10 * scale.sd;
  scale.x_of_level =
      find_root([&](double x) { return scale.mean(x) - level; }, ends.lowest - far, ends.highest + far);
  const Centre centre = centre_of(kept);
  const auto whole = fit(groups_of(kept, centre, -1), scale, start_of(*direct.fit, centre));
  if (!whole) return Refusal{whole.reason()};
  std::vector<Curve> without;
  for (int person = 0; person < people; ++person) {
    const auto rest = fit(groups_of(kept, centre, person), scale, *whole);
    if (!rest)
      return Refusal{"one participant decides whether there is a band: without them " + rest.reason()};
    without.push_back(curve_of(*rest, centre));
  }
  return jackknife_curve(curve_of(*whole, centre), without, solver_confidence);
}

}  // namespace stats
