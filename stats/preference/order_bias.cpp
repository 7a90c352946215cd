#include "stats/preference/order_bias.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stats/inference/distributions.hpp"
#include "stats/preference/bradley_terry.hpp"
#include "stats/preference/logit_fit.hpp"

namespace stats {

namespace {

enum class Terms { None, Interval, IntervalAndDrift };

/// One row for each trial: columns for the strengths of all items but the first, then those of the order
/// terms (bias towards the first interval, and its drift with the position).
std::vector<LogitRow> rows_with(std::span<const Comparison> trials, int items, Terms terms, double centre) {
  const auto strengths = static_cast<std::size_t>(items - 1);
  auto rows = trial_rows(trials, items, static_cast<std::size_t>(terms));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (terms != Terms::None) rows[i].design[strengths] = 1;
    if (terms == Terms::IntervalAndDrift) rows[i].design[strengths + 1] = trials[i].position - centre;
  }
  return rows;
}

struct OrderFit {
  std::vector<LogitRow> rows;
  Result<LogitFit> fit;
};

/// The last coefficient of `with`, tested against `without`, the fit without it.
OrderTerm last_term(const OrderFit& with, const LogitFit& without, std::span<const Comparison> trials,
                    double confidence) {
  const LogitFit& fit = *with.fit;
  const std::size_t size = fit.coefficients.size(), last = size - 1;
  const auto people = people_errors(fit, with.rows, trials);
  const CoefficientErrors errors = people ? *people : independent_errors(fit);
  OrderTerm out{.estimate = fit.coefficients[last],
                .se = std::sqrt(errors.variance(last, last, size)),
                .se_independent = std::sqrt(fit.variance(last, last)),
                .df = errors.df};
  const double half = errors.quantile(confidence) * out.se;
  out.ci = {out.estimate - half, out.estimate + half};
  out.p_wald = errors.p(out.estimate / out.se);
  out.lrt_chi2 = std::max(0.0, without.deviance - fit.deviance);
  out.lrt_p = chi2_upper(out.lrt_chi2, 1);
  return out;
}

}  // namespace

Result<OrderBias> order_bias(std::span<const Comparison> trials, int items, double confidence) {
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument("order_bias: the confidence is not between 0 and 1; give one such as 0.95");
  check_trials(trials, items);
  if (trials.empty()) return Refusal{"no trial"};
  if (items < 2) return Refusal{"fewer than two items"};
  OrderBias out;
  out.items = items;
  out.n = static_cast<int>(trials.size());
  out.confidence = confidence;
  double centre = 0;
  for (const auto& t : trials) {
    out.first_chosen += t.first_chosen;
    centre += t.position / static_cast<double>(trials.size());
  }
  if (const auto connected = connection(win_table(trials, items), items);
      connected.connection == Connection::None)
    return Refusal{connected.reason};

  const auto fit = [&](Terms terms) {
    auto rows = rows_with(trials, items, terms, centre);
    auto fitted = fit_logit(rows);
    return OrderFit{std::move(rows), std::move(fitted)};
  };
  const OrderFit with = fit(Terms::Interval), without = fit(Terms::None);
  if (!with.fit) return Refusal{"strengths and interval: " + with.fit.reason()};
  if (!without.fit) return Refusal{"strengths: " + without.fit.reason()};
  out.interval = last_term(with, *without.fit, trials, confidence);
  out.first_probability = logistic(out.interval.estimate);
  out.first_probability_ci = {logistic(out.interval.ci[0]), logistic(out.interval.ci[1])};
  const OrderFit drifting = fit(Terms::IntervalAndDrift);
  if (drifting.fit) out.drift = last_term(drifting, *with.fit, trials, confidence);
  return out;
}

}  // namespace stats
