#include "stats/inference/repeated_anova.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/inference/distributions.hpp"
#include "stats/inference/sample.hpp"

namespace stats {

namespace {

/// The table of participants by conditions as y = origin + scale * value, with |value| below 2, decomposed
/// into means and residuals. long double, since differences may be tiny compared with the offset.
struct Decomposition {
  double origin = 0, scale = 0;
  std::vector<long double> condition_means, subject_means, residuals;
  long double grand_mean = 0;
};

Decomposition decompose(const CompleteRows& table) {
  Decomposition d;
  const auto k = static_cast<std::size_t>(table.k), n = static_cast<std::size_t>(table.n);
  d.origin = table.values.front();
  // Halves, since the difference of two doubles may overflow.
  double half = 0;
  for (const double v : table.values) half = std::max(half, std::abs(v / 2 - d.origin / 2));
  d.scale = half > 0 ? std::ldexp(1.0, std::ilogb(half) + 1) : 1;

  d.condition_means.assign(k, 0);
  d.subject_means.assign(n, 0);
  d.residuals.resize(n * k);
  for (std::size_t cell = 0; cell < n * k; ++cell) {
    const long double value =
        (static_cast<long double>(table.values[cell]) - static_cast<long double>(d.origin)) / d.scale;
    d.residuals[cell] = value;
    d.condition_means[cell % k] += value / static_cast<long double>(n);
    d.subject_means[cell / k] += value / static_cast<long double>(k);
  }
  for (const auto mean : d.condition_means) d.grand_mean += mean / static_cast<long double>(k);
  for (std::size_t cell = 0; cell < n * k; ++cell)
    d.residuals[cell] -= d.condition_means[cell % k] + d.subject_means[cell / k] - d.grand_mean;
  return d;
}

long double squares_about(const std::vector<long double>& values, long double centre) {
  long double sum = 0;
  for (const auto v : values) sum += (v - centre) * (v - centre);
  return sum;
}

/// tr(S)^2 / ((k-1) tr(S^2)) of the residuals' covariance matrix S, which is centred in rows and columns.
double greenhouse_geisser(const std::vector<long double>& residuals, std::size_t k) {
  long double trace = 0, squares = 0;
  for (std::size_t i = 0; i < k; ++i) {
    for (std::size_t j = 0; j < k; ++j) {
      long double product = 0;
      for (std::size_t row = 0; row < residuals.size(); row += k)
        product += residuals[row + i] * residuals[row + j];
      if (i == j) trace += product;
      squares += product * product;
    }
  }
  const double epsilon = static_cast<double>(trace * trace / (static_cast<long double>(k - 1) * squares));
  return std::clamp(epsilon, 1 / static_cast<double>(k - 1), 1.0);
}

std::optional<double> huynh_feldt(double epsilon_gg, double n, double df1) {
  const double rest = n - 1 - df1 * epsilon_gg;
  if (rest < 1e-9 * n) return std::nullopt;
  return (n * df1 * epsilon_gg - 2) / (df1 * rest);
}

}  // namespace

Result<RepeatedAnova> repeated_anova(std::span<const double> rows, int k) {
  const CompleteRows table = complete_rows(rows, k);
  if (!table.refusal.empty()) return Refusal{table.refusal};
  RepeatedAnova out{.n = table.n, .n_missing = table.n_missing, .k = k};
  const Decomposition d = decompose(table);
  const long double conditions = table.n * squares_about(d.condition_means, d.grand_mean);
  const long double subjects = table.k * squares_about(d.subject_means, d.grand_mean);
  const long double error = squares_about(d.residuals, 0);
  // The scaled values are below 2, so a smaller sum of squares is only the rounding of data and means.
  constexpr long double rounding = 4 * std::numeric_limits<double>::epsilon();
  if (error <= static_cast<long double>(d.residuals.size()) * rounding * rounding)
    return Refusal{"no variation within participants is left beside the conditions' means"};

  const long double unit = static_cast<long double>(d.scale) * static_cast<long double>(d.scale);
  out.ss_conditions = static_cast<double>(conditions * unit);
  out.ss_subjects = static_cast<double>(subjects * unit);
  out.ss_error = static_cast<double>(error * unit);
  if (!std::isfinite(out.ss_conditions + out.ss_subjects + out.ss_error))
    return Refusal{"sums of squares beyond the range of double"};
  out.df1 = k - 1;
  out.df2 = out.df1 * (out.n - 1);
  out.f = static_cast<double>(conditions / error) * (out.n - 1);
  out.p = fisher_upper(out.f, out.df1, out.df2);
  out.epsilon_gg = greenhouse_geisser(d.residuals, static_cast<std::size_t>(k));
  out.epsilon_hf = huynh_feldt(out.epsilon_gg, out.n, out.df1);
  out.p_gg = fisher_upper(out.f, out.epsilon_gg * out.df1, out.epsilon_gg * out.df2);
  if (const auto epsilon = out.epsilon_hf_capped())
    out.p_hf = fisher_upper(out.f, *epsilon * out.df1, *epsilon * out.df2);
  out.partial_eta2 = static_cast<double>(conditions / (conditions + error));
  out.generalized_eta2 = static_cast<double>(conditions / (conditions + subjects + error));
  for (const auto mean : d.condition_means)
    out.means.push_back(static_cast<double>(d.origin + d.scale * mean));
  return out;
}

}  // namespace stats
