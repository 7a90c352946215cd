#include <algorithm>
#include <map>
#include <numeric>

#include "libstudy/design/assignment.hpp"
#include "libstudy/design/orders.hpp"
#include "libstudy/design/plan.hpp"

namespace study {

namespace {

/// Interval orders of pairs come in couples: a random order and its mirror.
constexpr int rounds_of_intervals = 32;

const StimulusSpec& stimulus_of(const Design& design, const std::vector<int>& group) {
  return design.cells[static_cast<std::size_t>(group.front())].stimulus;
}

/// Largest difference between the frequencies of two n_* in a sequence.
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

/// Every sequence of groups with different scenes; `even`: only those that spread n_* most evenly.
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

/// Rows of the square; 1 if there is none.
int rows_of(const Design& design) {
  if (design.order != TrialOrder::Latin && design.order != TrialOrder::Williams) return 1;
  int rows = 1;
  for (const auto& group : cell_groups(design)) {
    const auto cells = static_cast<int>(group.size());
    const int trials = design.pairs ? cells * (cells - 1) / 2 : cells;
    rows = std::lcm(rows, design.order == TrialOrder::Latin ? trials : williams_rows(trials));
  }
  return rows;
}

/// Rounds through all sequences before the assignment starts over.
int rounds_of(const Design& design) {
  const bool couples = design.pairs && design.assignment == Assignment::Balanced;
  return couples ? std::lcm(2 * rows_of(design), rounds_of_intervals) : rows_of(design);
}

std::vector<std::vector<int>> dealt_sequences(const Design& design) {
  return sequences_of(design, design.assignment == Assignment::Balanced);
}

}  // namespace

int sequence_count(const Protocol& protocol) {
  if (protocol.design.assignment == Assignment::PaperRandom) return 1;
  return static_cast<int>(dealt_sequences(protocol.design).size());
}

int slot_count(const Protocol& protocol) { return sequence_count(protocol) * rounds_of(protocol.design); }

int next_slot(const Protocol& protocol, const std::vector<int>& taken) {
  std::vector<int> count(static_cast<std::size_t>(slot_count(protocol)));
  for (const int slot : taken) ++count[static_cast<std::size_t>(slot) % count.size()];
  return static_cast<int>(std::min_element(count.begin(), count.end()) - count.begin());
}

Deal deal(const Protocol& protocol, int slot, std::uint64_t key) {
  const Design& design = protocol.design;
  const auto all = dealt_sequences(design);
  if (design.assignment == Assignment::PaperRandom) {
    RandomStream random(key, std::uint64_t{1} << 33);
    return {all[random.below(all.size())], slot, slot};
  }
  // Each round goes through all sequences in its own random order.
  const auto count = static_cast<int>(all.size());
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  const int round = slot / count;
  RandomStream random(random_key(protocol.sha256 + "\nround " + std::to_string(round)));
  shuffle(order, random);
  const int sequence = order[static_cast<std::size_t>(slot % count)];
  // Both rounds of a couple, whose intervals are mirrored, use the same rows.
  return {all[static_cast<std::size_t>(sequence)], round, sequence + (design.pairs ? round / 2 : round)};
}

std::vector<int> groups_met(const Protocol& protocol, int slot, std::uint64_t key) {
  return deal(protocol, slot, key).groups;
}

}  // namespace study
