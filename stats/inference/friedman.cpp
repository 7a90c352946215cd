#include "stats/inference/friedman.hpp"

#include <algorithm>
#include <functional>
#include <limits>

#include "stats/inference/distributions.hpp"
#include "stats/inference/ranks.hpp"
#include "stats/inference/sample.hpp"

namespace stats {

Result<Friedman> friedman_test(std::span<const double> rows, int k) {
  const CompleteRows table = complete_rows(rows, k);
  if (!table.refusal.empty()) return Refusal{table.refusal};
  Friedman out{.n = table.n, .n_missing = table.n_missing, .k = k};
  const double n = table.n, conditions = k;

  std::vector<double> sums(static_cast<std::size_t>(k), 0.0);
  double ties = 0;
  for (int i = 0; i < table.n; ++i) {
    const auto ranked = midranks(table.row(i));
    std::transform(sums.begin(), sums.end(), ranked.ranks.begin(), sums.begin(), std::plus());
    ties += ranked.tie_sum;
  }
  const double spread = n * conditions * (conditions + 1) - ties / (conditions - 1);
  if (!(spread > 0)) return Refusal{"every participant gave the same value to all conditions"};

  double squares = 0;
  for (const double sum : sums) {
    const double off = sum - n * (conditions + 1) / 2;
    squares += off * off;
    out.mean_ranks.push_back(sum / n);
  }
  out.chi2 = 12 * squares / spread;
  out.df = k - 1;
  out.p = chi2_upper(out.chi2, out.df);
  out.kendall_w = std::min(1.0, out.chi2 / (n * out.df));

  out.df1 = out.df;
  out.df2 = (n - 1) * out.df1;
  // rest = n (k - 1) spread - 12 squares, with spread = n k (k + 1) - ties / (k - 1) multiplied out: the
  // quotient may round, and then rest would not be exactly 0 where all participants have the same order.
  // Ranks are multiples of one half, so no term here rounds.
  const double rest = n * (n * conditions * (conditions * conditions - 1) - ties) - 12 * squares;
  out.iman_davenport_f = rest > 0 ? (n - 1) * 12 * squares / rest : std::numeric_limits<double>::infinity();
  out.iman_davenport_p = fisher_upper(out.iman_davenport_f, out.df1, out.df2);
  return out;
}

}  // namespace stats
