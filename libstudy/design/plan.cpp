#include "libstudy/design/plan.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "libstudy/design/adaptive_track.hpp"
#include "libstudy/design/orders.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// What the assignment deals to a slot (a place in the assignment, which one participant takes): the groups
/// of cells to show, and the row of the square (Latin or Williams) that orders their trials.
struct Deal {
  std::vector<int> groups;  ///< in order of presentation, as indices into cell_groups()
  int round = 0;            ///< number of complete passes through all sequences of groups before this slot
  /// Row of the square for the first group, modulo the number of rows; each later group takes the next row.
  /// Under Assignment::Balanced, over all slots, each sequence of groups begins with each row equally often.
  /// In a balanced design with pairs, each row also occurs equally often in each of the two interval orders.
  int row = 0;
};

/// A round is one pass through all sequences of groups. In a balanced design with pairs, the number of rounds
/// before the assignment starts over is a multiple of this number. Rounds come in couples: in the second
/// round of a couple, each pair has the opposite interval order of the first round. 32 rounds are 16 couples
/// with different random interval orders.
constexpr int rounds_of_intervals = 32;

const StimulusSpec& stimulus_of(const Design& design, const std::vector<int>& group) {
  return design.cells[static_cast<std::size_t>(group.front())].stimulus;
}

/// For each group the number of its n_* (size of the fluid): 0 for the first n_*, 1 for the next other one.
std::vector<std::size_t> n_star_numbers(const Design& design, const std::vector<std::vector<int>>& groups) {
  std::map<std::string, std::size_t> number;
  std::vector<std::size_t> out;
  for (const auto& group : groups)
    out.push_back(number.emplace(stimulus_of(design, group).n_star, number.size()).first->second);
  return out;
}

/// Of all n_* in `n_star`, which holds the number of each group's n_*: how often the most frequent one occurs
/// in a sequence of groups minus how often the least frequent one does, perhaps 0 times.
int unevenness(const std::vector<std::size_t>& n_star, const std::vector<int>& sequence) {
  std::vector<int> count(1 + *std::max_element(n_star.begin(), n_star.end()));
  for (const int index : sequence) ++count[n_star[static_cast<std::size_t>(index)]];
  const auto [least, most] = std::minmax_element(count.begin(), count.end());
  return *most - *least;
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

/// Every sequence of design.groups groups with different scenes. `even` true: only the sequences that spread
/// n_* most evenly.
std::vector<std::vector<int>> sequences_of(const Design& design, bool even) {
  const auto groups = cell_groups(design);
  std::vector<std::vector<int>> out;
  std::vector<int> sequence;
  extend(design, groups, sequence, out);
  if (!even) return out;
  const auto n_star = n_star_numbers(design, groups);
  int best = unevenness(n_star, out.front());
  for (const auto& one : out) best = std::min(best, unevenness(n_star, one));
  std::erase_if(out, [&](const auto& one) { return unevenness(n_star, one) > best; });
  return out;
}

/// Number of rows of the square (Latin or Williams); for groups of different sizes, the least common multiple
/// of their numbers of rows; 1 for other orders.
int rows_of(const Design& design) {
  if (design.order != TrialOrder::Latin && design.order != TrialOrder::Williams) return 1;
  int rows = 1;
  for (const auto& group : cell_groups(design)) {
    const auto pairs = static_cast<int>(pairs_of_group(design, group).size());
    const int trials = design.repetitions * (design.pairs ? pairs : static_cast<int>(group.size()));
    rows = std::lcm(rows, design.order == TrialOrder::Latin ? trials : williams_rows(trials));
  }
  return rows;
}

/// Number of passes through all sequences of groups before the assignment starts over.
int rounds_of(const Design& design) {
  const bool couples = design.pairs && design.assignment == Assignment::Balanced;
  return couples ? std::lcm(2 * rows_of(design), rounds_of_intervals) : rows_of(design);
}

std::vector<std::vector<int>> dealt_sequences(const Design& design) {
  return sequences_of(design, design.assignment == Assignment::Balanced);
}

/// The sequence of groups, the round and the row of the square for a slot; slot >= 0. Under
/// Assignment::PaperRandom the sequence is drawn at random with `key`, the participant's random key, and the
/// slot is round and row. Otherwise all follow from the slot and the protocol's hash, and `key` is not used.
Deal deal(const Protocol& protocol, int slot, std::uint64_t key) {
  const Design& design = protocol.design;
  const auto all = dealt_sequences(design);
  if (design.assignment == Assignment::PaperRandom) {
    RandomStream random(key, std::uint64_t{1} << 33);
    return {all[random.below(all.size())], slot, slot};
  }
  // Each round uses every sequence once, in a random order that differs between rounds.
  const auto count = static_cast<int>(all.size());
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  const int round = slot / count;
  RandomStream random(random_key(protocol.sha256 + "\nround " + std::to_string(round)));
  shuffle(order, random);
  const int sequence = order[static_cast<std::size_t>(slot % count)];
  // With pairs, two successive rounds (a couple) use the same rows, so each row occurs in both interval
  // orders (which stimulus of a pair comes first).
  return {all[static_cast<std::size_t>(sequence)], round, sequence + (design.pairs ? round / 2 : round)};
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

std::vector<int> groups_met(const Protocol& protocol, int slot, std::uint64_t key) {
  return deal(protocol, slot, key).groups;
}

namespace {

// First random counters of separate ranges, so that no two purposes share random numbers. One range is for
// schedule seeds. The range "extra" is for adaptive tracks, practice, repeats, catches and, under
// Assignment::PaperRandom, interval orders. Shuffles of trials start at counter 0, a random draw of groups at
// 2^33.
constexpr std::uint64_t first_schedule_counter = 1ull << 40;
constexpr std::uint64_t first_extra_counter = 1ull << 41;
constexpr std::uint64_t counters_per_block = 1ull << 32;
constexpr std::uint64_t counters_per_group = 1ull << 20;
constexpr std::uint64_t counters_per_repetition = 1ull << 22;

class Planner {
  using Pairs = std::vector<std::pair<int, int>>;

 public:
  Planner(const Protocol& protocol, const std::string& participant, std::uint64_t seed, int slot)
      : protocol_(protocol),
        design_(protocol.design),
        key_(random_key(protocol.sha256 + '\n' + participant + '\n' + std::to_string(seed))),
        random_(key_) {
    plan_.slot = slot;
    deal_ = deal(protocol, slot, key_);
  }

  Plan make() {
    for (std::size_t block = 0; block < protocol_.blocks.size(); ++block) add(static_cast<int>(block));
    scatter_catches();
    for (std::size_t i = 0; i < plan_.units.size(); ++i) plan_.units[i].position = static_cast<int>(i);
    return std::move(plan_);
  }

 private:
  const Block& block(int index) const { return protocol_.blocks[static_cast<std::size_t>(index)]; }

  void add(int index) {
    switch (block(index).kind) {
      case BlockKind::Stimulus:
        return add_design(index);
      case BlockKind::Practice:
        return add_practice(index);
      case BlockKind::Repeat:
        return add_repeats(index);
      case BlockKind::Catch:
        return;  // scatter_catches() adds catch pages among the trials
      default:
        add_page(index);
    }
  }

  void add_page(int index) { plan_.units.push_back({0, index, {}}); }

  void add_trial(PlannedTrial trial) {
    trial.position = static_cast<int>(plan_.trials.size());
    plan_.units.push_back({0, trial.block, trial.position});
    plan_.trials.push_back(trial);
  }

  /// Appends a trial of a Stimulus block. If a break is due, appends the break before the trial.
  void add_trial_or_break(const PlannedTrial& trial) {
    const int every = block(trial.block).break_every;
    const auto before = std::count_if(plan_.trials.begin(), plan_.trials.end(),
                                      [&](const PlannedTrial& one) { return one.block == trial.block; });
    if (every > 0 && before > 0 && before % every == 0) add_page(trial.block);
    add_trial(trial);
  }

  std::uint64_t schedule_seed(const PlannedTrial& trial, int repetition) const {
    const auto cells = static_cast<std::uint64_t>(repetition) * counters_per_repetition +
                       static_cast<std::uint64_t>(trial.first) * 4096 +
                       static_cast<std::uint64_t>(trial.second.value_or(0)) * 2;
    return counter_random(
        key_, first_schedule_counter + static_cast<std::uint64_t>(trial.block) * counters_per_block + cells);
  }

  void add_design(int index) {
    for (std::size_t g = 0; g < deal_.groups.size(); ++g) {
      if (g > 0 && block(index).between_groups_s > 0) add_page(index);
      if (design_.procedure) {
        add_tracks(static_cast<int>(g), index);
        continue;
      }
      const auto candidates = trials_of(static_cast<int>(g), index);
      for (const int i : order_of(candidates, static_cast<int>(g)))
        add_trial_or_break(candidates[static_cast<std::size_t>(i)]);
    }
  }

  /// Appends the trials of an adaptive procedure for the participant's g-th group (from 0). Their cells are
  /// placeholders, which chosen_trial() replaces during the session.
  void add_tracks(int g, int index) {
    auto random = extra(index);
    const auto group =
        cell_groups(design_)[static_cast<std::size_t>(deal_.groups[static_cast<std::size_t>(g)])];
    int number = 0;
    for (PlannedTrial trial : track_trials(design_, group, random)) {
      trial.block = index;
      trial.group = g;
      trial.schedule_seed = schedule_seed(trial, number++);
      add_trial_or_break(trial);
    }
  }

  /// All trials of the participant's g-th group (from 0), in the protocol's order of cells:
  /// design.repetitions times one trial for each cell or, in a design with pairs, for each pair of cells.
  /// `index`: the block.
  std::vector<PlannedTrial> trials_of(int g, int index) const {
    const auto cells =
        cell_groups(design_)[static_cast<std::size_t>(deal_.groups[static_cast<std::size_t>(g)])];
    std::vector<PlannedTrial> out;
    PlannedTrial trial;
    trial.block = index;
    trial.group = g;
    for (int repetition = 0; repetition < design_.repetitions; ++repetition) {
      const auto add = [&] {
        trial.schedule_seed = schedule_seed(trial, repetition);
        out.push_back(trial);
      };
      for (const auto& [first, second] : design_.pairs ? pairs_of_group(design_, cells) : Pairs()) {
        trial.first = first;
        trial.second = second;
        if (mirrored(g, static_cast<int>(out.size()))) std::swap(trial.first, *trial.second);
        add();
      }
      for (std::size_t i = 0; !design_.pairs && i < cells.size(); ++i) {
        trial.first = cells[i];
        add();
      }
    }
    return out;
  }

  /// True if trial number `pair` of group g, counted over all repetitions, shows the second cell of its pair
  /// first. The choice is random but equal for all participants of a round (a pass of the assignment through
  /// all sequences of groups); each odd round, counted from 0, has the opposite choices of the round before.
  /// Under Assignment::PaperRandom the choice is drawn for each participant.
  bool mirrored(int g, int pair) const {
    const auto which = static_cast<std::uint64_t>(g) * counters_per_group + static_cast<std::uint64_t>(pair);
    if (design_.assignment == Assignment::PaperRandom)
      return (counter_random(key_, first_extra_counter + which) & 1) != 0;
    const auto couple = random_key(protocol_.sha256 + "\ninterval " + std::to_string(deal_.round / 2));
    return ((counter_random(couple, which) ^ static_cast<std::uint64_t>(deal_.round)) & 1) != 0;
  }

  std::vector<int> order_of(const std::vector<PlannedTrial>& trials, int g) {
    const auto k = static_cast<int>(trials.size());
    const int row = deal_.row + g;
    if (design_.order == TrialOrder::Latin) return latin_row(k, row % k);
    if (design_.order == TrialOrder::Williams) return williams_row(k, row % williams_rows(k));
    if (design_.order == TrialOrder::Constrained) {
      const auto cell = [&](int i) -> const Cell& {
        return design_.cells[static_cast<std::size_t>(trials[static_cast<std::size_t>(i)].first)];
      };
      auto out = order_without_clashes(
          k, [&](int a, int b) { return share_level(design_, cell(a), cell(b)); }, random_);
      if (!out.empty()) return out;
      throw base::Error("protocol " + protocol_.name,
                        "no order of the trials was found that satisfies design.never_adjacent",
                        "name fewer factors in never_adjacent, or remove it and use order = \"shuffle\"");
    }
    std::vector<int> out(trials.size());
    std::iota(out.begin(), out.end(), 0);
    shuffle(out, random_);
    return out;
  }

  RandomStream extra(int index) const {
    return RandomStream(key_,
                        first_extra_counter + static_cast<std::uint64_t>(index + 1) * counters_per_block);
  }

  /// Draws practice trials from the participant's first group without replacement; once all trials are drawn,
  /// draws from all of them again.
  void add_practice(int index) {
    auto random = extra(index);
    const auto candidates = trials_of(0, index);
    add_drawn(candidates, block(index).count, index, random);
  }

  /// Adds repeats of trials drawn at random from the block that the key `like` of this block names, with the
  /// stimuli and frame intervals of the drawn trials.
  void add_repeats(int index) {
    auto random = extra(index);
    std::vector<PlannedTrial> shown;
    for (const auto& trial : plan_.trials) {
      if (block(trial.block).id == block(index).like) shown.push_back(trial);
    }
    add_drawn(shown, block(index).count, index, random);
  }

  void add_drawn(const std::vector<PlannedTrial>& candidates, int count, int index, RandomStream& random) {
    std::vector<PlannedTrial> left;
    for (int i = 0; i < count; ++i) {
      if (left.empty()) {
        left = candidates;
        shuffle(left, random);
      }
      left.back().block = index;
      add_trial(left.back());
      left.pop_back();
    }
  }

  /// Puts each catch page after a different trial, drawn at random from the trials of the block that the key
  /// `like` of the page's block names.
  void scatter_catches() {
    for (std::size_t index = 0; index < protocol_.blocks.size(); ++index) {
      const Block& catches = protocol_.blocks[index];
      if (catches.kind != BlockKind::Catch) continue;
      std::vector<int> places;
      for (const auto& trial : plan_.trials) {
        if (block(trial.block).id == catches.like) places.push_back(trial.position);
      }
      auto random = extra(static_cast<int>(index));
      shuffle(places, random);
      places.resize(std::min(places.size(), static_cast<std::size_t>(catches.count)));
      for (const int place : places) {
        const auto after = std::find_if(plan_.units.begin(), plan_.units.end(),
                                        [&](const PlannedUnit& unit) { return unit.trial == place; });
        plan_.units.insert(after + 1, {0, static_cast<int>(index), {}});
      }
    }
  }

  const Protocol& protocol_;
  const Design& design_;
  std::uint64_t key_;
  RandomStream random_;
  Plan plan_;
  Deal deal_;
};

}  // namespace

Plan make_plan(const Protocol& protocol, const std::string& participant, std::uint64_t seed, int slot) {
  return Planner(protocol, participant, seed, slot).make();
}

}  // namespace study
