#include <algorithm>
#include <map>
#include <numeric>

#include "libstudy/design/orders.hpp"
#include "libstudy/design/plan.hpp"

namespace study {

namespace {

/// Interval orders of pairs come in couples of a random one and its mirror.
constexpr int rounds_of_intervals = 32;

const StimulusSpec& stimulus_of(const Design& design, const std::vector<int>& group) {
  return design.cells[static_cast<std::size_t>(group.front())].stimulus;
}

/// Largest difference between how often two n_* of the design are met.
int unevenness(const Design& design, const std::vector<std::vector<int>>& groups,
               const std::vector<int>& sequence) {
  std::map<std::string, int> count;
  for (const auto& group : groups) count[stimulus_of(design, group).n_star] = 0;
  for (const int index : sequence)
    ++count[stimulus_of(design, groups[static_cast<std::size_t>(index)]).n_star];
  const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto [least, most] = std::minmax_element(count.begin(), count.end(), less);
  return most->second - least->second;
}

void extend(const Design& design, const std::vector<std::vector<int>>& groups, std::vector<int>& sequence,
            std::vector<std::vector<int>>& out) {
  if (static_cast<int>(sequence.size()) == design.groups) {
    out.push_back(sequence);
    return;
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::string& scene = stimulus_of(design, groups[i]).scene;
    const bool met = std::any_of(sequence.begin(), sequence.end(), [&](int j) {
      return stimulus_of(design, groups[static_cast<std::size_t>(j)]).scene == scene;
    });
    if (met) continue;
    sequence.push_back(static_cast<int>(i));
    extend(design, groups, sequence, out);
    sequence.pop_back();
  }
}

/// Every order of groups with different scenes; balanced: those alone that spread n_* most evenly.
std::vector<std::vector<int>> sequences_of(const Design& design, bool even) {
  const auto groups = cell_groups(design);
  std::vector<std::vector<int>> out;
  std::vector<int> sequence;
  extend(design, groups, sequence, out);
  if (!even) return out;
  int best = unevenness(design, groups, out.front());
  for (const auto& one : out) best = std::min(best, unevenness(design, groups, one));
  std::erase_if(out, [&](const auto& one) { return unevenness(design, groups, one) > best; });
  return out;
}

int trials_of_group(const Design& design) {
  const auto k = static_cast<int>(cell_groups(design).front().size());
  return design.pairs ? k * (k - 1) / 2 : k;
}

int rows_of(const Design& design) {
  if (design.order == TrialOrder::Latin) return trials_of_group(design);
  return design.order == TrialOrder::Williams ? williams_rows(trials_of_group(design)) : 1;
}

}  // namespace

int sequence_count(const Protocol& protocol) {
  if (protocol.design.assignment == Assignment::PaperRandom) return 1;
  return static_cast<int>(sequences_of(protocol.design, true).size());
}

int slot_count(const Protocol& protocol) {
  const Design& design = protocol.design;
  return sequence_count(protocol) * std::lcm(rows_of(design), design.pairs ? rounds_of_intervals : 1);
}

int next_slot(const Protocol& protocol, const std::vector<int>& taken) {
  std::vector<int> count(static_cast<std::size_t>(slot_count(protocol)));
  for (const int slot : taken) ++count.at(static_cast<std::size_t>(slot) % count.size());
  return static_cast<int>(std::min_element(count.begin(), count.end()) - count.begin());
}

std::vector<int> groups_met(const Protocol& protocol, int slot, std::uint64_t key) {
  const Design& design = protocol.design;
  if (design.assignment == Assignment::PaperRandom) {
    const auto all = sequences_of(design, false);
    RandomStream random(key, std::uint64_t{1} << 33);
    return all[random.below(all.size())];
  }
  // Within each round through all sequences, an order of its own.
  auto all = sequences_of(design, true);
  const auto round = slot / static_cast<int>(all.size());
  RandomStream random(random_key(protocol.sha256 + "\nround " + std::to_string(round)));
  shuffle(all, random);
  return all[static_cast<std::size_t>(slot) % all.size()];
}

}  // namespace study
