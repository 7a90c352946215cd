#include "stats/analysis/share_test.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "stats/inference/binomial.hpp"
#include "stats/inference/t_test.hpp"

namespace stats {

namespace {

constexpr std::int64_t largest_sum = 1'000'000;

/// Distribution of the sum of +-values, each sign with probability one half, from -total to total in steps of
/// one.
std::vector<double> distribution_of(const std::vector<std::int64_t>& values, std::int64_t total) {
  std::vector<double> mass(static_cast<std::size_t>(2 * total + 1), 0.0);
  const auto at = [&](std::int64_t sum) { return static_cast<std::size_t>(sum + total); };
  mass[at(0)] = 1;
  std::int64_t reach = 0;
  for (const std::int64_t value : values) {
    std::vector<double> next(mass.size(), 0.0);
    for (std::int64_t sum = -reach; sum <= reach; ++sum) {
      if (mass[at(sum)] == 0) continue;
      next[at(sum + value)] += mass[at(sum)] / 2;
      next[at(sum - value)] += mass[at(sum)] / 2;
    }
    mass = std::move(next);
    reach += value;
  }
  return mass;
}

void add_interval(ShareTest& out, const std::vector<double>& shares, Alternative alternative,
                  double confidence) {
  out.ci = {0, 1};
  out.ci_name = "0 to 1, as all shares are equal";
  const auto test = t_test_one(shares, {alternative, confidence, 0.5, false});
  if (test) {
    out.ci = {std::max(0.0, test->ci[0]), std::min(1.0, test->ci[1])};
    out.ci_name = "Student's t of people's shares, within 0 to 1";
    return;
  }
  const auto n = static_cast<int>(shares.size());
  const bool always_alike = shares[0] == 0 || shares[0] == 1;
  if (!always_alike) return;
  const auto counted = binomial_test(shares[0] == 1 ? n : 0, n, 0.5, alternative, confidence);
  if (!counted) return;
  out.ci = counted->clopper_pearson;
  out.ci_name = "Clopper-Pearson over people, as all always chose alike";
}

}  // namespace

Result<ShareTest> share_test(std::span<const PersonChoices> people, Alternative alternative,
                             double confidence) {
  if (people.empty()) return Refusal{"no answers"};
  std::int64_t common = 1;
  for (const auto& one : people) {
    common = std::lcm(common, std::int64_t{one.n});
    if (common > largest_sum) return Refusal{"the numbers of answers have no small common denominator"};
  }
  std::vector<std::int64_t> values;
  std::vector<double> shares;
  std::int64_t sum = 0, total = 0;
  for (const auto& one : people) {
    const std::int64_t value = (2 * one.k - one.n) * (common / one.n);
    sum += value;
    total += std::abs(value);
    values.push_back(std::abs(value));
    shares.push_back(static_cast<double>(one.k) / one.n);
    if (total > largest_sum) return Refusal{"the numbers of answers have no small common denominator"};
  }
  const auto mass = distribution_of(values, total);
  double p = 0;
  for (std::int64_t at = -total; at <= total; ++at) {
    const bool counts = alternative == Alternative::Greater ? at >= sum
                        : alternative == Alternative::Less  ? at <= sum
                                                            : std::abs(at) >= std::abs(sum);
    if (counts) p += mass[static_cast<std::size_t>(at + total)];
  }
  ShareTest out;
  out.participants = static_cast<int>(people.size());
  out.share = std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
  add_interval(out, shares, alternative, confidence);
  out.p = std::min(1.0, p);
  return out;
}

}  // namespace stats
