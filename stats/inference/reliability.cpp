#include "stats/inference/reliability.hpp"

#include <numeric>
#include <stdexcept>
#include <vector>

#include "stats/inference/describe.hpp"
#include "stats/inference/distributions.hpp"
#include "stats/inference/sample.hpp"
#include "stats/root.hpp"

namespace stats {

namespace {

/// The x with P(F >= x) = p.
double fisher_upper_quantile(double p, double df1, double df2) {
  const auto beyond = [&](double x) { return fisher_upper(x, df1, df2) - p; };
  double high = 1;
  while (beyond(high) > 0) high *= 2;
  return find_root(beyond, 0, high);
}

double sample_variance(std::span<const double> values) {
  const double sd = describe(values)->sd.value_or(0);
  return sd * sd;
}

}  // namespace

Result<CronbachAlpha> cronbach_alpha(std::span<const double> rows, int items, double confidence) {
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument(
        "cronbach_alpha: the confidence is not between 0 and 1; give one such as 0.95");
  const auto table = complete_rows(rows, items);
  if (!table.refusal.empty()) return Refusal{table.refusal};
  std::vector<double> sums;
  double of_items = 0;
  for (int i = 0; i < table.n; ++i) {
    const auto row = table.row(i);
    sums.push_back(std::accumulate(row.begin(), row.end(), 0.0));
  }
  for (int item = 0; item < items; ++item) {
    std::vector<double> column;
    for (int i = 0; i < table.n; ++i) column.push_back(table.row(i)[static_cast<std::size_t>(item)]);
    of_items += sample_variance(column);
  }
  const double of_sums = sample_variance(sums);
  if (of_sums <= 0) return Refusal{"the sums of the items do not differ"};
  CronbachAlpha out{items, table.n, table.n_missing, 0, {}};
  out.alpha = items / (items - 1.0) * (1 - of_items / of_sums);
  const double df1 = table.n - 1, df2 = df1 * (items - 1), tail = (1 - confidence) / 2;
  out.ci = {1 - (1 - out.alpha) * fisher_upper_quantile(tail, df1, df2),
            1 - (1 - out.alpha) * fisher_upper_quantile(1 - tail, df1, df2)};
  return out;
}

}  // namespace stats
