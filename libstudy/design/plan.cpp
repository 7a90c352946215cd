#include "libstudy/design/plan.hpp"

#include <numeric>

namespace study {

namespace {
// Schedule seeds are drawn far from the counters of the shuffle.
constexpr std::uint64_t first_schedule_counter = 1ull << 40;
}  // namespace

std::vector<PlannedTrial> make_plan(const Protocol& protocol, const std::string& participant,
                                    std::uint64_t seed) {
  const std::uint64_t key = random_key(protocol.sha256 + '\n' + participant + '\n' + std::to_string(seed));
  std::vector<int> order(protocol.settings.size());
  std::iota(order.begin(), order.end(), 0);
  RandomStream random(key);
  shuffle(order, random);

  std::vector<PlannedTrial> plan(order.size());
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const auto setting = static_cast<std::uint64_t>(order[i]);
    plan[i] = {static_cast<int>(i), order[i], counter_random(key, first_schedule_counter + setting)};
  }
  return plan;
}

}  // namespace study
