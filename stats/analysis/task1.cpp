#include "stats/analysis/task1.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/inference/adjust.hpp"

namespace stats {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

BootstrapOptions bootstrap_options(const AnalysisPlan& plan) {
  BootstrapOptions options;
  options.resamples = plan.resamples;
  options.seed = plan.seed;
  options.confidence = plan.confidence;
  return options;
}

MethodCell describe_cell(const ScoreTable& table, int n_star, int method, const AnalysisPlan& plan) {
  MethodCell cell;
  cell.n_star = n_star;
  cell.method = method;
  for (const double value : table.column(n_star, method)) {
    if (!std::isnan(value)) cell.values.push_back(value);
  }
  cell.summary = describe(cell.values);
  cell.box = box_plot(cell.values);
  if (cell.box) {
    for (const double value : cell.values) {
      if (value < cell.box->low_whisker || value > cell.box->high_whisker) cell.outliers.push_back(value);
    }
  }
  cell.mean = t_test_one(cell.values, {Alternative::TwoSided, plan.confidence, 0});
  cell.bootstrap = bootstrap_interval(cell.values, mean_statistic(), bootstrap_options(plan));
  cell.normality = shapiro_wilk(cell.values);
  return cell;
}

std::optional<double> mean_if_any(const std::vector<double>& values) {
  const auto summary = describe(values);
  if (!summary) return {};
  return summary->mean;
}

MethodComparison compare(const ScoreTable& table, int n_star, int a, int b, const AnalysisPlan& plan) {
  MethodComparison out;
  out.n_star = n_star;
  out.a = a;
  out.b = b;
  const auto x = table.column(n_star, a), y = table.column(n_star, b);
  for (std::size_t i = 0; i < x.size(); ++i) out.n_missing += std::isnan(x[i]) != std::isnan(y[i]) ? 1 : 0;
  const PairedValues pairs = complete_pairs(x, y);
  out.n = pairs.x.size();
  out.mean_a = mean_if_any(pairs.x);
  out.mean_b = mean_if_any(pairs.y);
  const TTestOptions two_sided{Alternative::TwoSided, plan.confidence, 0};
  out.t = t_test_paired(pairs.x, pairs.y, two_sided);
  out.welch = t_test_welch(pairs.x, pairs.y, two_sided);
  const auto exact = exact_differences(table.means(n_star, a), table.means(n_star, b));
  if (!out.t && exact) out.unanimous = unanimous(*exact);
  out.wilcoxon = exact ? signed_rank(*exact, plan.confidence) : Refusal{exact.reason()};
  const double margin = table.scale().margin;
  out.equivalence = equivalence_paired(pairs.x, pairs.y, {-margin, margin}, plan.alpha);
  const auto differences = exact ? exact->values() : pairs.differences();
  out.normality = shapiro_wilk(differences);
  out.bootstrap = bootstrap_interval(differences, mean_statistic(), bootstrap_options(plan));
  return out;
}

/// Corrects one kind of p-value over the comparisons at one n_* (nominal number of particles).
template <class GetP>
void correct(std::span<MethodComparison> family, GetP p_of, std::optional<double> MethodComparison::*holm,
             std::optional<double> MethodComparison::*bh) {
  std::vector<double> p;
  for (const MethodComparison& comparison : family) p.push_back(p_of(comparison));
  const auto by_holm = adjust(p, Adjustment::Holm, p.size());
  const auto by_bh = adjust(p, Adjustment::BenjaminiHochberg, p.size());
  for (std::size_t i = 0; i < family.size(); ++i) {
    if (by_holm && !std::isnan(p[i])) family[i].*holm = by_holm->p[i];
    if (by_bh && !std::isnan(p[i])) family[i].*bh = by_bh->p[i];
  }
}

void correct_all(std::span<MethodComparison> family) {
  correct(
      family, [](const MethodComparison& one) { return one.p().value_or(missing); },
      &MethodComparison::p_holm, &MethodComparison::p_bh);
  correct(
      family, [](const MethodComparison& one) { return one.wilcoxon ? one.wilcoxon->p() : missing; },
      &MethodComparison::wilcoxon_p_holm, &MethodComparison::wilcoxon_p_bh);
  correct(
      family, [](const MethodComparison& one) { return one.mixed ? one.mixed->p : missing; },
      &MethodComparison::mixed_p_holm, &MethodComparison::mixed_p_bh);
}

Omnibus test_all_methods(const ScoreTable& table, int n_star) {
  const auto rows = table.rows(n_star);
  const auto k = static_cast<int>(table.methods().size());
  Omnibus out;
  out.n_star = n_star;
  for (auto row = rows.begin(); row != rows.end(); row += k) {
    const bool complete = std::none_of(row, row + k, [](double value) { return std::isnan(value); });
    ++(complete ? out.n : out.n_incomplete);
  }
  out.friedman = friedman_test(rows, k);
  out.anova = repeated_anova(rows, k);
  return out;
}

PairPeople count_people(const ScoreTable& table, int n_star, std::span<const MethodComparison> pairs) {
  PairPeople out;
  out.n_star = n_star;
  const auto methods = static_cast<int>(table.methods().size());
  for (std::size_t p = 0; p < static_cast<std::size_t>(table.participants()); ++p) {
    int planned = 0, judged = 0;
    for (int m = 0; m < methods; ++m) {
      planned += table.planned(n_star, m)[p];
      judged += std::isnan(table.column(n_star, m)[p]) ? 0 : 1;
    }
    out.planned += planned > 0 ? 1 : 0;
    out.any += judged > 0 ? 1 : 0;
    out.all += judged == methods ? 1 : 0;
    out.differ = out.differ || (judged > 1 && judged < methods);
  }
  const auto by_n = [](const MethodComparison& a, const MethodComparison& b) { return a.n < b.n; };
  if (pairs.empty()) return out;
  const auto [fewest, most] = std::minmax_element(pairs.begin(), pairs.end(), by_n);
  out.fewest = fewest->n;
  out.most = most->n;
  return out;
}

}  // namespace

std::optional<double> MethodComparison::p() const {
  if (t) return t->p;
  if (unanimous) return unanimous->p(Alternative::TwoSided);
  return {};
}

std::vector<double> PairedValues::differences() const {
  std::vector<double> out(x.size());
  std::transform(x.begin(), x.end(), y.begin(), out.begin(), std::minus<>());
  return out;
}

PairedValues complete_pairs(std::span<const double> x, std::span<const double> y) {
  PairedValues out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i]) || std::isnan(y[i])) continue;
    out.x.push_back(x[i]);
    out.y.push_back(y[i]);
  }
  return out;
}

ScoreAnalysis analyse_scores(const ScoreTable& table, const AnalysisPlan& plan) {
  ScoreAnalysis out;
  out.mixed = fit_mixed_scores(table);
  const auto methods = static_cast<int>(table.methods().size());
  for (int n_star = 0; n_star < static_cast<int>(table.n_stars().size()); ++n_star) {
    const std::size_t first = out.comparisons.size();
    for (int a = 0; a < methods; ++a) {
      out.cells.push_back(describe_cell(table, n_star, a, plan));
      for (int b = a + 1; b < methods; ++b) out.comparisons.push_back(compare(table, n_star, a, b, plan));
    }
    const auto pairs = std::span(out.comparisons).subspan(first);
    for (auto& one : pairs)
      one.mixed = out.mixed ? out.mixed->difference(one.n_star, one.a, one.b, plan.confidence)
                            : Refusal{out.mixed.reason()};
    correct_all(pairs);
    out.people.push_back(count_people(table, n_star, pairs));
    out.omnibus.push_back(test_all_methods(table, n_star));
  }
  return out;
}

}  // namespace stats
