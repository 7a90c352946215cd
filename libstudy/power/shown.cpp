#include "libstudy/power/shown.hpp"

#include <algorithm>
#include <span>

#include "libstudy/design/plan.hpp"
#include "stats/analysis/mixed_scores.hpp"

namespace study {

namespace {

int index_or_add(std::vector<std::string>& list, const std::string& item) {
  const auto found = std::find(list.begin(), list.end(), item);
  if (found != list.end()) return static_cast<int>(found - list.begin());
  list.push_back(item);
  return static_cast<int>(list.size()) - 1;
}

/// Sets the periods of one participant's trials. Trials with the same scene and n_* form a block, and a
/// period is a run of successive trials of one block.
void count_periods(std::span<ShownTrial> trials, const ShownFactors& factors) {
  std::vector<int> blocks;
  for (const auto& trial : trials) {
    const auto& place = factors.cells[static_cast<std::size_t>(trial.first)];
    blocks.push_back(place.scene * static_cast<int>(factors.n_stars.size()) + place.n_star);
  }
  const auto periods = stats::periods_of(blocks);
  for (std::size_t i = 0; i < trials.size(); ++i) trials[i].period = periods[i];
}

}  // namespace

ShownFactors::ShownFactors(const Design& design) {
  std::vector<std::string> alone;  // names of the methods without their level of effects
  for (const auto& cell : design.cells) {
    const StimulusSpec& what = cell.stimulus;
    cells.push_back({index_or_add(scenes, what.scene), index_or_add(n_stars, what.n_star),
                     index_or_add(methods, treatment_name(what))});
    if (!design.effects.empty() && treatments.size() < methods.size())
      treatments.push_back({index_or_add(effects, what.effects), index_or_add(alone, what.method)});
  }
}

std::vector<ShownTrial> planned_trials(const Protocol& protocol, std::uint64_t seed, int n) {
  const int slots = slot_count(protocol);
  const ShownFactors factors(protocol.design);
  std::vector<ShownTrial> out;
  for (int participant = 0; participant < n; ++participant) {
    // A new session gets a slot with the fewest participants, so the slots are 0, 1, ... in turn, then again
    // from 0.
    const auto plan = make_plan(protocol, "P" + std::to_string(participant + 1), seed, participant % slots);
    const auto before = out.size();
    for (const auto& trial : plan.trials) {
      if (protocol.blocks[static_cast<std::size_t>(trial.block)].kind == BlockKind::Stimulus)
        out.push_back({participant, trial.first, trial.second.value_or(-1), trial.position, 0});
    }
    count_periods(std::span(out).subspan(before), factors);
  }
  return out;
}

}  // namespace study
