#include "stats/preference/order_bias.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/inference/tails.hpp"
#include "stats/preference/bradley_terry.hpp"
#include "stats/preference/logit_fit.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

enum class Terms { None, Interval, IntervalAndDrift };

void check(std::span<const Comparison> trials, int items) {
  const auto outside = [items](int item) { return item < 0 || item >= items; };
  for (const auto& t : trials) {
    if (outside(t.first) || outside(t.second) || t.first == t.second || !std::isfinite(t.position))
      throw std::invalid_argument("a comparison of items outside the list, or without a position");
  }
}

/// One row for each trial: strengths of all items but the first, then the terms.
std::vector<LogitRow> trial_rows(std::span<const Comparison> trials, int items, Terms terms, double centre) {
  const auto strengths = static_cast<std::size_t>(items - 1);
  const std::size_t columns = strengths + static_cast<std::size_t>(terms);
  std::vector<LogitRow> rows;
  for (const auto& t : trials) {
    LogitRow row{std::vector<double>(columns, 0.0), t.first_chosen ? 1.0 : 0.0, 1};
    if (t.first > 0) row.design[static_cast<std::size_t>(t.first - 1)] = 1;
    if (t.second > 0) row.design[static_cast<std::size_t>(t.second - 1)] = -1;
    if (terms != Terms::None) row.design[strengths] = 1;
    if (terms == Terms::IntervalAndDrift) row.design[strengths + 1] = t.position - centre;
    rows.push_back(std::move(row));
  }
  return rows;
}

/// The last coefficient of `with`, tested against the fit without it.
OrderTerm last_term(const LogitFit& with, const LogitFit& without, double z) {
  const std::size_t last = with.coefficients.size() - 1;
  OrderTerm out{.estimate = with.coefficients[last], .se = std::sqrt(with.variance(last, last))};
  out.ci = {out.estimate - z * out.se, out.estimate + z * out.se};
  out.p_wald = normal_two_sided(out.estimate / out.se);
  out.lrt_chi2 = std::max(0.0, without.deviance - with.deviance);
  out.lrt_p = chi2_upper(out.lrt_chi2, 1);
  return out;
}

double logistic(double x) { return 1 / (1 + std::exp(-x)); }

}  // namespace

Result<OrderBias> order_bias(std::span<const Comparison> trials, int items, double confidence) {
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument("a confidence must lie between 0 and 1");
  check(trials, items);
  if (trials.empty()) return Refusal{"no trial"};
  if (items < 2) return Refusal{"fewer than two items"};
  std::vector<double> wins(static_cast<std::size_t>(items) * static_cast<std::size_t>(items), 0.0);
  OrderBias out;
  out.items = items;
  out.n = static_cast<int>(trials.size());
  out.confidence = confidence;
  double centre = 0;
  for (const auto& t : trials) {
    const int winner = t.first_chosen ? t.first : t.second, loser = t.first_chosen ? t.second : t.first;
    wins[static_cast<std::size_t>(winner) * static_cast<std::size_t>(items) +
         static_cast<std::size_t>(loser)] += 1;
    out.first_chosen += t.first_chosen;
    centre += t.position / static_cast<double>(trials.size());
  }
  if (const auto connected = connection(wins, items); connected.connection == Connection::None)
    return Refusal{connected.reason};

  const auto fit = [&](Terms terms) { return fit_logit(trial_rows(trials, items, terms, centre)); };
  const auto with = fit(Terms::Interval);
  if (!with) return Refusal{"strengths and interval: " + with.reason()};
  const auto without = fit(Terms::None);
  if (!without) return Refusal{"strengths: " + without.reason()};
  const double z = normal_quantile(0.5 + confidence / 2);
  out.interval = last_term(*with, *without, z);
  out.first_probability = logistic(out.interval.estimate);
  out.first_probability_ci = {logistic(out.interval.ci[0]), logistic(out.interval.ci[1])};
  if (const auto drifting = fit(Terms::IntervalAndDrift)) out.drift = last_term(*drifting, *with, z);
  return out;
}

}  // namespace stats
