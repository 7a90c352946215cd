#include "stats/preference/bradley_terry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "stats/cholesky.hpp"
#include "stats/inference/distributions.hpp"
#include "stats/preference/logit_fit.hpp"

namespace stats {

namespace {

using Values = std::vector<double>;

struct Wins {
  std::span<const double> counts;
  int items;
  double operator()(int i, int j) const {
    return counts[static_cast<std::size_t>(i) * static_cast<std::size_t>(items) +
                  static_cast<std::size_t>(j)];
  }
};

Wins checked(std::span<const double> wins, int items) {
  const auto n = static_cast<std::size_t>(std::max(items, 0));
  if (items < 1 || wins.size() != n * n)
    throw std::invalid_argument(
        "Bradley-Terry: the wins do not fit the number of items; give items x items counts, items at least "
        "1");
  for (std::size_t i = 0; i < wins.size(); ++i) {
    if (!(wins[i] >= 0) || std::isinf(wins[i]))
      throw std::invalid_argument(
          "Bradley-Terry: a count of wins is negative or not finite; give finite counts of 0 or more");
    if (i % (n + 1) == 0 && wins[i] > 0)
      throw std::invalid_argument(
          "Bradley-Terry: an item has wins over itself; set the diagonal of the wins to 0");
  }
  return {wins, items};
}

/// Items reachable from `start` by steps for which `edge` is true.
template <class Edge>
std::vector<bool> reachable(int items, int start, const Edge& edge) {
  std::vector<bool> seen(static_cast<std::size_t>(items), false);
  std::vector<int> todo{start};
  seen[static_cast<std::size_t>(start)] = true;
  while (!todo.empty()) {
    const int from = todo.back();
    todo.pop_back();
    for (int to = 0; to < items; ++to) {
      if (seen[static_cast<std::size_t>(to)] || !edge(from, to)) continue;
      seen[static_cast<std::size_t>(to)] = true;
      todo.push_back(to);
    }
  }
  return seen;
}

std::string names(const std::vector<bool>& members) {
  std::string list;
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (members[i]) list += (list.empty() ? "" : ", ") + std::to_string(i + 1);
  }
  return (std::count(members.begin(), members.end(), true) == 1 ? "item " : "items ") + list;
}

bool all(const std::vector<bool>& members) {
  return std::find(members.begin(), members.end(), false) == members.end();
}

/// The smallest set of items that no item outside it ever beat (for `worst`: that never beat an item outside
/// it).
std::vector<bool> unbeaten(const Wins& wins, bool worst) {
  std::vector<bool> best(static_cast<std::size_t>(wins.items), true);
  for (int i = 0; i < wins.items; ++i) {
    auto set = reachable(wins.items, i, [&](int a, int b) { return (worst ? wins(a, b) : wins(b, a)) > 0; });
    if (std::count(set.begin(), set.end(), true) < std::count(best.begin(), best.end(), true)) best = set;
  }
  return best;
}

std::vector<LogitRow> pair_rows(const Wins& wins) {
  std::vector<LogitRow> rows;
  for (int i = 0; i < wins.items; ++i) {
    for (int j = i + 1; j < wins.items; ++j) {
      const double trials = wins(i, j) + wins(j, i);
      if (!(trials > 0)) continue;
      LogitRow row{Values(static_cast<std::size_t>(wins.items - 1), 0.0), wins(i, j), trials};
      if (i > 0) row.design[static_cast<std::size_t>(i - 1)] = 1;
      row.design[static_cast<std::size_t>(j - 1)] = -1;
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

void set_strengths(BradleyTerry& out, const LogitFit& fit) {
  out.lambda_ref1.assign(1, 0.0);
  out.lambda_ref1.insert(out.lambda_ref1.end(), fit.coefficients.begin(), fit.coefficients.end());
  double mean = 0, total = 0;
  for (const double lambda : out.lambda_ref1) mean += lambda / static_cast<double>(out.items);
  for (const double lambda : out.lambda_ref1) total += std::exp(lambda - mean);
  for (const double lambda : out.lambda_ref1) {
    out.lambda_sum0.push_back(lambda - mean);
    out.worth.push_back(std::exp(lambda - mean) / total);
  }
}

void set_covariance(BradleyTerry& out, const CoefficientErrors& errors) {
  const auto n = static_cast<std::size_t>(out.items);
  out.se_ref1.assign(n, 0.0);
  out.covariance_ref1.assign(n * n, 0.0);
  for (std::size_t i = 1; i < n; ++i) {
    out.se_ref1[i] = std::sqrt(errors.variance(i - 1, i - 1, n - 1));
    for (std::size_t j = 1; j < n; ++j) out.covariance_ref1[i * n + j] = errors.variance(i - 1, j - 1, n - 1);
  }
}

void set_centred(BradleyTerry& out, double quantile) {
  const auto n = static_cast<std::size_t>(out.items);
  const auto items = static_cast<double>(out.items);
  double mean_covariance = 0;
  Values row_means(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) row_means[i] += out.covariance_ref1[i * n + j] / items;
    mean_covariance += row_means[i] / items;
  }
  out.se_sum0.clear();
  out.ci_sum0.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const double variance = out.covariance_ref1[i * n + i] - 2 * row_means[i] + mean_covariance;
    const double lambda = out.lambda_sum0[i], se = std::sqrt(std::max(0.0, variance));
    out.se_sum0.push_back(se);
    out.ci_sum0.push_back({lambda - quantile * se, lambda + quantile * se});
  }
}

void set_pairs(BradleyTerry& out, const CoefficientErrors& errors, double quantile) {
  const auto n = static_cast<std::size_t>(out.items);
  out.pairs.clear();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      PairDifference pair{.i = static_cast<int>(i), .j = static_cast<int>(j)};
      pair.difference = out.lambda_ref1[i] - out.lambda_ref1[j];
      pair.se = std::sqrt(std::max(0.0, out.covariance_ref1[i * n + i] + out.covariance_ref1[j * n + j] -
                                            2 * out.covariance_ref1[i * n + j]));
      pair.ci = {pair.difference - quantile * pair.se, pair.difference + quantile * pair.se};
      pair.p = errors.p(pair.difference / pair.se);
      pair.probability = logistic(pair.difference);
      pair.probability_ci = {logistic(pair.ci[0]), logistic(pair.ci[1])};
      out.pairs.push_back(pair);
    }
  }
}

void set_errors(BradleyTerry& out, const CoefficientErrors& errors) {
  const double quantile = errors.quantile(out.confidence);
  set_covariance(out, errors);
  set_centred(out, quantile);
  set_pairs(out, errors, quantile);
}

/// Replaces the standard errors that treat answers as independent by those that take each person's answers as
/// one cluster; the former stay in the fields se_independent and se_sum0_independent.
void set_people(BradleyTerry& out, const CoefficientErrors& errors, const LogitFit& fit) {
  const auto before = out.pairs;
  set_errors(out, errors);
  for (std::size_t i = 0; i < before.size(); ++i) out.pairs[i].se_independent = before[i].se;
  out.people_df = errors.df;
  const auto k = static_cast<double>(out.items - 1), people = *errors.df + 1;
  const auto factor = Cholesky::of(errors.covariance);
  if (!factor || people <= k) return;
  const Values solved = factor->solve(fit.coefficients);
  double t2 = 0;
  for (std::size_t i = 0; i < solved.size(); ++i) t2 += solved[i] * fit.coefficients[i];
  BradleyTerry::PeopleTest test{t2 * (people - k) / (k * (people - 1)), k, people - k, 0};
  test.p = fisher_upper(test.f, test.df1, test.df2);
  out.equal_over_people = test;
}

void set_tests(BradleyTerry& out, const LogitFit& fit, std::span<const LogitRow> rows) {
  out.log_likelihood = fit.log_likelihood;
  out.gof_deviance = fit.deviance;
  out.gof_df = static_cast<int>(rows.size()) - (out.items - 1);
  if (out.gof_df > 0) out.gof_p = chi2_upper(out.gof_deviance, out.gof_df);
  // Subtracts deviances, not likelihoods, so that small differences of large sums are accurate.
  double equal = 0;
  for (const auto& row : rows) {
    equal += 2 * (deviance_part(row.successes, row.trials / 2) +
                  deviance_part(row.trials - row.successes, row.trials / 2));
  }
  out.lrt_chi2 = std::max(0.0, equal - fit.deviance);
  out.lrt_df = out.items - 1;
  out.lrt_p = chi2_upper(out.lrt_chi2, out.lrt_df);
}

}  // namespace

ConnectionReport connection(std::span<const double> counts, int items) {
  const Wins wins = checked(counts, items);
  const auto group = reachable(items, 0, [&](int a, int b) { return wins(a, b) + wins(b, a) > 0; });
  if (!all(group)) return {Connection::None, names(group) + " and the others were never compared"};
  const auto best = unbeaten(wins, false);
  if (all(best)) return {};
  const auto worst = unbeaten(wins, true);
  const bool many = std::count(best.begin(), best.end(), true) > std::count(worst.begin(), worst.end(), true);
  const auto& set = many ? worst : best;
  const bool one = std::count(set.begin(), set.end(), true) == 1;
  return {Connection::Separated, names(set) + (one ? "" : " together") +
                                     (one    ? many ? " loses" : " wins"
                                      : many ? " lose"
                                             : " win") +
                                     " every comparison with the others"};
}

namespace {

/// A model and the fit it was built from.
struct Fitted {
  BradleyTerry model;
  LogitFit fit;
};

Result<Fitted> fit_wins(std::span<const double> counts, int items, BradleyTerryMethod method,
                        double confidence) {
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument(
        "bradley_terry: the confidence is not between 0 and 1; give one such as 0.95");
  const Wins wins = checked(counts, items);
  if (items < 2) return Refusal{"fewer than two items"};
  const auto rows = pair_rows(wins);
  if (rows.empty()) return Refusal{"no comparison"};
  const ConnectionReport connected = connection(counts, items);
  if (connected.connection == Connection::None) return Refusal{connected.reason};

  const bool separated = connected.connection == Connection::Separated;
  if (separated && method == BradleyTerryMethod::MaximumLikelihood)
    return Refusal{"infinite estimates: " + connected.reason};
  BradleyTerry out;
  out.items = items;
  out.confidence = confidence;
  out.bias_reduced = separated || method == BradleyTerryMethod::BiasReduced;
  if (separated && method == BradleyTerryMethod::Automatic) out.why_bias_reduced = connected.reason;
  for (const auto& row : rows) out.comparisons += row.trials;

  const auto fit = fit_logit(rows, out.bias_reduced ? LogitBias::Reduced : LogitBias::AsIs);
  if (!fit) return Refusal{fit.reason()};
  set_strengths(out, *fit);
  set_errors(out, independent_errors(*fit));
  out.se_sum0_independent = out.se_sum0;
  for (PairDifference& pair : out.pairs) pair.se_independent = pair.se;
  set_tests(out, *fit, rows);
  return Fitted{std::move(out), *fit};
}

}  // namespace

Result<BradleyTerry> bradley_terry(std::span<const double> counts, int items, BradleyTerryMethod method,
                                   double confidence) {
  const auto fitted = fit_wins(counts, items, method, confidence);
  if (!fitted) return Refusal{fitted.reason()};
  return fitted->model;
}

Result<BradleyTerry> bradley_terry(std::span<const Comparison> trials, int items, BradleyTerryMethod method,
                                   double confidence) {
  check_trials(trials, items);
  const auto fitted = fit_wins(win_table(trials, items), items, method, confidence);
  if (!fitted) return Refusal{fitted.reason()};
  BradleyTerry out = fitted->model;
  if (out.bias_reduced) {
    out.why_independent = "the strengths are penalised";
    return out;
  }
  const auto errors = people_errors(fitted->fit, trial_rows(trials, items), trials);
  if (errors) {
    set_people(out, *errors, fitted->fit);
  } else {
    out.why_independent = errors.reason();
  }
  return out;
}

}  // namespace stats
