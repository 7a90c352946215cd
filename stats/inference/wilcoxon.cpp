#include "stats/inference/wilcoxon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "stats/inference/ranks.hpp"
#include "stats/inference/sample.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

constexpr std::size_t largest_exact_n = 1000;
/// Most Walsh averages held in memory at once (200 MB).
constexpr double most_pairs = 2.5e7;

double two_sided(const RankSumTails& tails) { return std::min(1.0, 2 * std::min(tails.lower, tails.upper)); }

/// Two-sided normal p of a statistic at `distance` from its mean, with a continuity `correction`.
double normal_p(double distance, double variance, double correction) {
  const double z = std::max(std::abs(distance) - correction, 0.0) / std::sqrt(variance);
  return 2 * normal_probability(-z);
}

double median_in_place(std::vector<double>& values) {
  const auto half = values.size() / 2;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(half);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2) return *middle;
  return std::midpoint(*std::max_element(values.begin(), middle), *middle);
}

/// Sums of the ranks of positive and of negative differences, zeros left out.
struct SignedRanks {
  std::vector<double> ranks;  ///< ranks of the differences that are not zero
  double plus = 0, minus = 0, squares = 0;
  double mean() const { return (plus + minus) / 2; }
  double variance() const { return squares / 4; }
};

SignedRanks by_sign(std::span<const double> differences, std::span<const double> ranks) {
  SignedRanks out;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    if (differences[i] == 0) continue;
    (differences[i] > 0 ? out.plus : out.minus) += ranks[i];
    out.squares += ranks[i] * ranks[i];
    out.ranks.push_back(ranks[i]);
  }
  return out;
}

std::vector<double> magnitudes(std::span<const double> values) {
  std::vector<double> out;
  for (const double v : values) out.push_back(std::abs(v));
  return out;
}

std::vector<double> walsh_averages(std::span<const double> values) {
  std::vector<double> out;
  out.reserve(values.size() * (values.size() + 1) / 2);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = i; j < values.size(); ++j) out.push_back(std::midpoint(values[i], values[j]));
  }
  return out;
}

struct Cut {
  std::size_t averages = 0;
  double level = 0;  ///< coverage of the remaining interval
};

/// Number of Walsh averages to cut off at each end: one less than the smallest sum w of ranks 1..n with P(W
/// <= w) >= tail; 0 if even w = 0 is too likely.
Cut averages_to_cut(std::size_t n, double tail) {
  std::vector<double> weights(n * (n + 1) / 2 + 1, 0.0);
  weights[0] = 1;
  for (std::size_t rank = 1; rank <= n; ++rank) {
    for (std::size_t s = rank * (rank + 1) / 2 + 1; s-- > 0;)
      weights[s] = (weights[s] + (s >= rank ? weights[s - rank] : 0)) / 2;
  }
  double sum = 0, below = 0;  // P(W <= w) and P(W < w)
  std::size_t w = 0;
  // The tolerance allows for rounding of a sum that equals the tail.
  while ((sum += weights[w]) < tail * (1 - 1e-14)) {
    below = sum;
    ++w;
  }
  if (w == 0) return {0, 1 - 2 * weights[0]};
  return {w - 1, 1 - 2 * below};
}

void fill_location(SignedRank& out, std::span<const double> differences, double confidence) {
  auto walsh = walsh_averages(differences);
  if (out.n <= largest_exact_n) {
    std::sort(walsh.begin(), walsh.end());
    const auto cut = averages_to_cut(out.n, (1 - confidence) / 2);
    out.hodges_lehmann_ci = {walsh[cut.averages], walsh[walsh.size() - 1 - cut.averages]};
    out.hodges_lehmann_level = cut.level;
  }
  out.hodges_lehmann = median_in_place(walsh);
}

void fill_pratt(SignedRank& out, std::span<const double> differences) {
  const auto all = midranks(magnitudes(differences));
  const auto s = by_sign(differences, all.ranks);
  out.pratt_w_plus = s.plus;
  out.pratt_z = (s.plus - s.mean()) / std::sqrt(s.variance());
  out.pratt_p_normal = normal_p(s.plus - s.mean(), s.variance(), 0);
  if (out.n <= largest_exact_n) out.pratt_p_exact = two_sided(signed_rank_tails(s.ranks, s.plus));
}

}  // namespace

Result<SignedRank> signed_rank(std::span<const double> differences, double confidence) {
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument("signed_rank: the confidence is not between 0 and 1; give one such as 0.95");
  const auto sample = present(differences);
  if (!sample) return Refusal{sample.reason()};
  if (sample->values.empty()) return Refusal{"no values"};
  const auto n_values = static_cast<double>(sample->values.size());
  if (n_values * (n_values + 1) / 2 > most_pairs) return Refusal{"more pairs of values than 2.5e7"};
  std::vector<double> nonzero;
  for (const double d : sample->values) {
    if (d != 0) nonzero.push_back(d);
  }
  if (nonzero.empty()) return Refusal{"no difference that is not zero"};

  const auto ranked = midranks(magnitudes(nonzero));
  const auto s = by_sign(nonzero, ranked.ranks);
  SignedRank out;
  out.n = sample->values.size();
  out.n_missing = sample->n_missing;
  out.n_nonzero = nonzero.size();
  out.has_ties = ranked.has_ties();
  out.w_plus = s.plus;
  out.w_minus = s.minus;
  out.rank_biserial = (s.plus - s.minus) / (s.plus + s.minus);
  if (out.n_nonzero <= largest_exact_n) {
    const auto tails = signed_rank_tails(s.ranks, s.plus);
    out.p_exact = two_sided(tails);
    out.p_exact_less = tails.lower;
    out.p_exact_greater = tails.upper;
  }
  out.p_normal = normal_p(s.plus - s.mean(), s.variance(), 0.5);
  out.p_normal_uncorrected = normal_p(s.plus - s.mean(), s.variance(), 0);
  fill_pratt(out, sample->values);
  fill_location(out, sample->values, confidence);
  return out;
}

Result<SignedRank> signed_rank(const ExactDifferences& differences, double confidence) {
  const auto whole = signed_rank(differences.numerators, confidence);
  if (!whole) return whole;
  SignedRank out = *whole;
  out.n_missing = differences.n_missing;
  out.hodges_lehmann /= differences.denominator;
  if (out.hodges_lehmann_ci)
    for (double& end : *out.hodges_lehmann_ci) end /= differences.denominator;
  return out;
}

}  // namespace stats
