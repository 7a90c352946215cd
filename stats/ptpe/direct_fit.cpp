#include "stats/ptpe/direct_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "stats/ptpe/term_sums.hpp"

namespace stats {

namespace {

/// The sums of products of the first three terms alone: 1, x (log of the mean frame rate) and d (its standard
/// deviation), both centred.
template <std::size_t Terms>
std::array<double, 9> plane_gram(const TermSums<Terms>& sums) {
  std::array<double, 9> gram{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) gram[i * 3 + j] = sums.gram[i * Terms + j];
  }
  return gram;
}

}  // namespace

/// Parameters of the model in centred variables: u = x - alpha - beta d, with x = log mu and d = delta /
/// delta_unit, both minus their means, for a frame rate of mean mu and standard deviation delta. The score
/// minus the level is u (k + m d + q u).
struct DirectModel::Place {
  static constexpr std::size_t terms = DirectModel::terms, parameters = 5;
  double alpha = 0, beta = 0, k = 0, m = 0, q = 0;

  std::array<double, terms> coefficients() const {
    return {-k * alpha + q * alpha * alpha,
            k - 2 * q * alpha,
            -k * beta - m * alpha + 2 * q * alpha * beta,
            m - 2 * q * beta,
            q,
            -m * beta + q * beta * beta};
  }
  /// Derivatives of coefficients(): one row each for alpha, beta, k, m and q.
  std::array<std::array<double, terms>, 5> jacobian() const {
    return {{{-k + 2 * q * alpha, -2 * q, -m + 2 * q * beta, 0, 0, 0},
             {0, 0, -k + 2 * q * alpha, -2 * q, 0, -m + 2 * q * beta},
             {-alpha, 1, -beta, 0, 0, 0},
             {0, 0, -alpha, 1, 0, -beta},
             {alpha * alpha, -2 * alpha, 2 * alpha * beta, -2 * beta, 1, beta * beta}}};
  }
  Place moved(const std::array<double, 5>& step) const {
    return {alpha + step[0], beta + step[1], k + step[2], m + step[3], q + step[4]};
  }
  /// The same surface, described by the other line on which the score equals the level.
  Place other() const { return {alpha - k / q, beta - m / q, -k, -m, q}; }
};

DirectModel::DirectModel(std::span<const PilotObservation> observations, double level) : level_(level) {
  int participants = 0;
  double n = 0;
  for (const auto& o : observations) {
    if (!(o.mu > 0))
      throw std::invalid_argument(
          "DirectModel: a mean frame rate is not above 0; leave out observations of such settings");
    participants = std::max(participants, o.participant + 1);
    log_mu_centre_ += std::log(o.mu);
    delta_centre_ += o.delta;
    n += 1;
  }
  if (n == 0) return;
  log_mu_centre_ /= n;
  delta_centre_ /= n;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  log_mu_range_ = delta_range_ = {infinity, -infinity};
  sums_.resize(static_cast<std::size_t>(participants));
  for (const auto& o : observations) {
    const double x = std::log(o.mu) - log_mu_centre_, d = (o.delta - delta_centre_) / delta_unit;
    const std::array<double, terms> row{1, x, d, x * d, x * x, d * d};
    sums_[static_cast<std::size_t>(o.participant)].add(row, o.score - level);
    log_mu_range_ = {std::min(log_mu_range_[0], std::log(o.mu)), std::max(log_mu_range_[1], std::log(o.mu))};
    delta_range_ = {std::min(delta_range_[0], o.delta), std::max(delta_range_[1], o.delta)};
  }
}

DirectModel::Sums DirectModel::weighted(std::span<const double> weights) const {
  if (!weights.empty() && weights.size() != sums_.size())
    throw std::invalid_argument(
        "DirectModel: not one weight for each participant; give as many as participants(), or none");
  Sums out;
  for (std::size_t p = 0; p < sums_.size(); ++p) {
    const double w = weights.empty() ? 1 : weights[p];
    if (w != 0) out.add(sums_[p], w);
  }
  return out;
}

/// Ordinary least squares of the score on 1, x (log of the mean frame rate) and d (its standard deviation),
/// both centred. Empty if the settings do not determine the plane or the score does not depend on x.
std::optional<DirectModel::Place> DirectModel::straight(const Sums& sums) const {
  const auto c = solve_positive<3>(plane_gram(sums), {sums.moment[0], sums.moment[1], sums.moment[2]});
  if (!c || std::abs((*c)[1]) < 1e-12) return std::nullopt;
  return Place{-(*c)[0] / (*c)[1], -(*c)[2] / (*c)[1], (*c)[1], 0, 0};
}

/// Why straight() is empty.
Refusal DirectModel::no_slope(const Sums& sums, const std::string& surface) {
  if (!solve_positive<3>(plane_gram(sums), {}))
    return {"the settings rated do not determine a " + surface + " over mean and deviation"};
  const double mean = sums.moment[0] / sums.n;
  const bool equal = sums.squares - sums.n * mean * mean <= 1e-12 * sums.squares;
  return {equal ? "all ratings are equal" : "the scores do not depend on the mean frame rate"};
}

/// Chooses, of the two lines on which the score equals the level, the one at which the score rises with mu.
Result<DirectFit> DirectModel::checked(const Sums& sums, const Place& at) const {
  if (at.k < 0 && std::abs(at.q) > 1e-12) {
    if (const auto rising = described(sums, at.other())) return rising;
  }
  return described(sums, at);
}

Result<DirectFit> DirectModel::described(const Sums& sums, const Place& at) const {
  DirectFit fit;
  fit.level = level_;
  fit.curve.b = at.beta / delta_unit;
  fit.curve.log_a = at.alpha + log_mu_centre_ - fit.curve.b * delta_centre_;
  fit.m = at.m / delta_unit;
  fit.k = at.k - fit.m * delta_centre_;
  fit.q = at.q;
  fit.rss = std::max(0.0, sums.residuals(at.coefficients()));
  fit.n = sums.n;
  if (!std::isfinite(fit.curve.log_a) || !std::isfinite(fit.curve.b) || !std::isfinite(fit.rss))
    return Refusal{"the fit left the range of double precision"};
  constexpr int steps = 20;
  bool rises = true, inside = false;
  for (int i = 0; i <= steps; ++i) {
    const double delta = std::lerp(delta_range_[0], delta_range_[1], i / double{steps});
    const double log_mu = fit.curve.log_a + fit.curve.b * delta;
    if (log_mu < log_mu_range_[0] || log_mu > log_mu_range_[1]) continue;
    inside = true;
    rises &= fit.k + fit.m * delta > 0;
  }
  if (!inside)
    return Refusal{"no contour: the model's curve does not meet the level within the settings shown"};
  if (!rises) return Refusal{"the scores do not rise with the frame rate all along the curve"};
  return fit;
}

Result<DirectFit> DirectModel::fit(std::span<const double> weights, const DirectFit* start) const {
  const auto sums = weighted(weights);
  const auto plane = straight(sums);
  const auto scale = std::max(sums.n, 1.0);
  auto ridge = sums.gram;
  for (double& g : ridge) g /= scale;
  if (!plane) return no_slope(sums, "surface");
  if (!solve_positive<terms>(ridge, {}))
    return Refusal{"the settings rated do not determine a surface over mean and deviation"};
  std::vector<Place> starts{*plane};
  if (start) {
    const double b = start->curve.b, m = start->m;
    starts.push_back({start->curve.log_a + b * delta_centre_ - log_mu_centre_, b * delta_unit,
                      start->k + m * delta_centre_, m * delta_unit, start->q});
  } else {
    for (const double alpha : {-0.4, 0.0, 0.4}) {
      for (const double beta : {-0.2, 0.2, 0.6}) starts.push_back({alpha, beta, plane->k, 0, 0});
    }
  }
  Place best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& from : starts) {
    const auto end = descend(sums, from);
    const double value = sums.residuals(end.coefficients());
    if (value < least - 1e-9 * sums.squares) {
      least = value;
      best = end;
    }
  }
  return checked(sums, best);
}

Result<DirectFit> DirectModel::fit_straight(std::span<const double> weights) const {
  const auto sums = weighted(weights);
  const auto plane = straight(sums);
  if (!plane) return no_slope(sums, "plane");
  return checked(sums, *plane);
}

double DirectFit::score(double mu, double delta) const {
  const double u = std::log(mu) - curve.log_a - curve.b * delta;
  return level + u * (k + m * delta + q * u);
}

}  // namespace stats
