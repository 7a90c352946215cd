#include "stats/preference/circular_triads.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/inference/distributions.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

using Values = std::vector<double>;

constexpr int most_exact = 7;

int all_triads(int items) { return items * (items - 1) * (items - 2) / 6; }

/// Largest possible number of circular triads (Kendall and Babington Smith 1940).
int most_circular(int items) {
  const int n = items;
  return n % 2 == 1 ? (n * n * n - n) / 24 : (n * n * n - 4 * n) / 24;
}

/// An item with s wins beats both others in s (s - 1) / 2 triads; a triad in which no item beats both others
/// is circular.
int heads(int wins) { return wins * (wins - 1) / 2; }

/// Share of each number of circular triads among all tournaments. The tournaments are enumerated in Gray
/// code, so that each differs from the one before it in one answer.
Values enumerate(int items) {
  std::vector<std::array<std::size_t, 2>> pairs;
  std::vector<int> score(static_cast<std::size_t>(items), 0);
  for (std::size_t i = 0; i < score.size(); ++i) {
    for (std::size_t j = i + 1; j < score.size(); ++j) {
      pairs.push_back({i, j});
      ++score[i];
    }
  }
  int headed = 0;
  for (const int s : score) headed += heads(s);
  std::vector<bool> turned(pairs.size(), false);
  Values counts(static_cast<std::size_t>(most_circular(items)) + 1, 0.0);
  const std::uint32_t tournaments = 1u << pairs.size();
  for (std::uint32_t code = 1;; ++code) {
    ++counts[static_cast<std::size_t>(all_triads(items) - headed)];
    if (code == tournaments) break;
    const auto flip = static_cast<std::size_t>(std::countr_zero(code));
    const auto [i, j] = pairs[flip];
    const auto from = turned[flip] ? j : i, to = turned[flip] ? i : j;
    turned[flip] = !turned[flip];
    headed += score[to] - (score[from] - 1);  // heads(s + 1) - heads(s) = s
    --score[from];
    ++score[to];
  }
  for (double& count : counts) count /= tournaments;
  return counts;
}

const Values& exact_distribution(int items) {
  static const std::array<Values, most_exact + 1> known = [] {
    std::array<Values, most_exact + 1> all;
    for (int n = 3; n <= most_exact; ++n) all[static_cast<std::size_t>(n)] = enumerate(n);
    return all;
  }();
  return known[static_cast<std::size_t>(items)];
}

double share_up_to(const Values& shares, int largest) {
  return std::min(1.0, std::accumulate(shares.begin(), shares.begin() + largest + 1, 0.0));
}

Values convolve(const Values& a, const Values& b) {
  Values out(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) out[i + j] += a[i] * b[j];
  return out;
}

/// p by Kendall's chi-square approximation (Kendall 1962, section 11.10).
double approximate_p(int items, int triads) {
  const double n = items;
  const double df = n * (n - 1) * (n - 2) / ((n - 4) * (n - 4));
  return chi2_upper(8 / (n - 4) * (all_triads(items) / 4.0 - triads + 0.5) + df, df);
}

}  // namespace

Result<CircularTriads> circular_triads(std::span<const double> wins, int items) {
  const auto n = static_cast<std::size_t>(std::max(items, 0));
  if (wins.size() != n * n)
    throw std::invalid_argument(
        "circular_triads: the wins do not fit the number of items; give items x items entries");
  if (items < 3) return Refusal{"fewer than three items have no triad"};
  if (items > 1000) return Refusal{"more than 1,000 items"};
  CircularTriads out{.items = items, .triads = all_triads(items), .most = most_circular(items)};
  for (std::size_t i = 0; i < n; ++i) {
    int score = 0;
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j) continue;
      const double won = wins[i * n + j], lost = wins[j * n + i];
      if (!((won == 1 && lost == 0) || (won == 0 && lost == 1)))
        return Refusal{"items " + std::to_string(i + 1) + " and " + std::to_string(j + 1) +
                       " were not compared exactly once"};
      score += won == 1;
    }
    out.triads -= heads(score);
  }
  out.expected = all_triads(items) / 4.0;
  out.zeta = 1 - static_cast<double>(out.triads) / out.most;
  out.exact = items <= most_exact;
  out.p = out.exact ? share_up_to(exact_distribution(items), out.triads) : approximate_p(items, out.triads);
  return out;
}

Result<GroupTriads> group_triads(std::span<const CircularTriads> participants) {
  if (participants.empty()) return Refusal{"no participant with all pairs"};
  GroupTriads out{.participants = static_cast<int>(participants.size()), .items = participants.front().items};
  for (const auto& one : participants) {
    if (one.items != out.items) return Refusal{"participants judged different numbers of items"};
    out.triads += one.triads;
    out.expected += one.expected;
    out.mean_zeta += one.zeta / out.participants;
  }
  out.exact = out.items <= most_exact;
  if (out.exact) {
    Values sum{1.0};
    for (int i = 0; i < out.participants; ++i) sum = convolve(sum, exact_distribution(out.items));
    out.p = share_up_to(sum, out.triads);
  } else {
    // Each triad is circular with probability 1/4, and any two triads are independent.
    const double sd = std::sqrt(0.75 * out.expected);
    out.p = normal_probability((out.triads + 0.5 - out.expected) / sd);
  }
  return out;
}

}  // namespace stats
