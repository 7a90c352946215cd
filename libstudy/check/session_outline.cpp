#include "libstudy/check/session_outline.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <map>
#include <sstream>
#include <tuple>

#include "libstudy/design/orders.hpp"
#include "libstudy/session/participant.hpp"

namespace study {

namespace {

using study::BlockKind;
using study::StepKind;

double reading_s(const std::string& text, const Pace& pace) {
  if (pace.words_per_s <= 0) return 0;
  std::istringstream words(text);
  double count = 0;
  for (std::string word; words >> word;) ++count;
  return count / pace.words_per_s;
}

double page_s(const Block& block, const Pace& pace) {
  switch (block.kind) {
    case BlockKind::Stimulus:
      return block.between_groups_s + block.break_s + pace.break_s;
    case BlockKind::Rest:
    case BlockKind::Black:
      return block.seconds;
    case BlockKind::Break:
      return block.seconds + pace.break_s;
    default:
      return std::max(block.seconds, reading_s(block.text, pace)) +
             static_cast<double>(block.questions.size()) * pace.answer_s;
  }
}

double trial_s(const Protocol& protocol, const PlannedTrial& trial, double answer_s) {
  const auto& block = protocol.blocks[static_cast<std::size_t>(trial.block)];
  double seconds = 0;
  for (const auto& step : block.steps) {
    const int cell = step.interval == 0 ? trial.first : trial.second.value_or(trial.first);
    if (step.kind == StepKind::Stimulus)
      seconds += protocol.design.cells[static_cast<std::size_t>(cell)].setting.duration_s +
                 (trial.second ? word_s + after_word_s : 0);
    seconds += step.seconds + static_cast<double>(step.asks.size()) * answer_s;
  }
  return seconds;
}

Span unit_s(const Protocol& protocol, const Plan& plan, const PlannedUnit& unit) {
  if (!unit.trial) {
    const auto& block = protocol.blocks[static_cast<std::size_t>(unit.block)];
    return {page_s(block, quick_pace), page_s(block, slow_pace)};
  }
  const auto& trial = plan.trials[static_cast<std::size_t>(*unit.trial)];
  return {trial_s(protocol, trial, quick_pace.answer_s), trial_s(protocol, trial, slow_pace.answer_s)};
}

void add(Span& sum, const Span& part) {
  sum.least += part.least;
  sum.most += part.most;
}

std::string step_words(const Protocol& protocol, const TrialStep& step) {
  switch (step.kind) {
    case StepKind::Black:
      return fmt::format("black {:g} s", step.seconds);
    case StepKind::Rest:
      return fmt::format("rest {:g} s", step.seconds);
    case StepKind::Ask:
      return fmt::format("ask {}", step.asks.size());
    default:
      return fmt::format("stimulus {:g} s", protocol.design.cells.front().setting.duration_s);
  }
}

int rows_of_square(const Design& design) {
  if (design.order == TrialOrder::Latin) return trials_of_group(design);
  if (design.order != TrialOrder::Williams) return 1;
  return williams_rows(trials_of_group(design));
}

}  // namespace

SessionOutline outline_session(const Protocol& protocol) {
  const auto plan = make_plan(protocol, "P01", 1, 0);
  SessionOutline out;
  for (const auto& block : protocol.blocks) out.blocks.push_back({&block, 0, 0, {}});
  for (const auto& unit : plan.units) {
    auto& outline = out.blocks[static_cast<std::size_t>(unit.block)];
    const Span seconds = unit_s(protocol, plan, unit);
    ++(unit.trial ? outline.trials : outline.pages);
    add(outline.seconds, seconds);
    add(out.session_s, seconds);
    if (!unit.trial || outline.block->kind != BlockKind::Stimulus) continue;
    add(out.trials_s, seconds);
    out.shown_s += trial_s(protocol, plan.trials[static_cast<std::size_t>(*unit.trial)], 0);
  }
  out.units = static_cast<int>(plan.units.size());
  out.trials = static_cast<int>(plan.trials.size());
  return out;
}

std::string describe_block(const Protocol& protocol, const BlockOutline& outline) {
  const Block& block = *outline.block;
  if (has_trials(block.kind)) {
    std::string out = fmt::format("{} trials: ", outline.trials);
    for (const auto& step : block.steps)
      out += (&step == &block.steps.front() ? "" : ", ") + step_words(protocol, step);
    if (block.break_every > 0)
      out += fmt::format("; a break of {:g} s after every {} trials", block.break_s, block.break_every);
    else if (outline.pages > 0)
      out += fmt::format("; {:g} s between groups", block.between_groups_s);
    return out;
  }
  std::string out;
  if (block.kind == BlockKind::Catch) out = fmt::format("{} pages among the trials", outline.pages);
  if (!block.questions.empty())
    out += fmt::format("{}{} question{}", out.empty() ? "" : ", ", block.questions.size(),
                       block.questions.size() == 1 ? "" : "s");
  if (block.seconds > 0)
    out += fmt::format("{}{:g} s{}", out.empty() ? "" : ", ", block.seconds,
                       block.kind == BlockKind::Rest || block.kind == BlockKind::Black ? "" : " at least");
  return out;
}

PlannedBalance check_balance(const Protocol& protocol) {
  const Design& design = protocol.design;
  PlannedBalance out;
  out.planned = protocol.participants;
  out.sequences = sequence_count(protocol);
  std::map<std::vector<int>, int> met;
  // Key: sequence of groups, lower and higher index of a pair's cells. Value: number of people who see the
  // lower cell first, minus number of people who see the higher cell first.
  std::map<std::tuple<std::vector<int>, int, int>, int> difference;
  const int slots = slot_count(protocol);
  const bool dealt = design.assignment == Assignment::Balanced;
  for (int slot = 0; dealt && slot < std::min(slots, out.planned); ++slot) {
    const int people = out.planned / slots + (slot < out.planned % slots);
    const auto groups = groups_met(protocol, slot, 0);
    met[groups] += people;
    if (!design.pairs) continue;
    for (const auto& trial : make_plan(protocol, "P", 1, slot).trials) {
      if (protocol.blocks[static_cast<std::size_t>(trial.block)].kind != BlockKind::Stimulus) continue;
      const auto [low, high] = std::minmax(trial.first, *trial.second);
      difference[{groups, low, high}] += trial.first == low ? people : -people;
    }
  }
  if (dealt) {
    out.least = static_cast<int>(met.size()) < out.sequences ? 0 : out.planned;
    for (const auto& [groups, count] : met) {
      out.least = std::min(out.least, count);
      out.most = std::max(out.most, count);
    }
    for (const auto& [pair, count] : difference)
      out.interval_difference = std::max(out.interval_difference, std::abs(count));
  }
  out.even = out.sequences * rows_of_square(design) * (design.pairs && dealt ? 2 : 1);
  out.even_below = out.planned / out.even * out.even;
  out.even_above = out.even_below == out.planned ? out.planned : out.even_below + out.even;
  return out;
}

std::string describe_balance(const Protocol& protocol, const PlannedBalance& balance) {
  const Design& design = protocol.design;
  std::string out = fmt::format("{} participants: ", balance.planned);
  if (design.assignment == Assignment::PaperRandom)
    out += "scenes, n_* and intervals are drawn for each";
  else if (balance.sequences == 1)
    out += "all meet the same cells";
  else
    out += fmt::format("each of {} {} is met by {} of them", balance.sequences,
                       design.factors.empty() ? "sequences of scene and n_*" : "between-subject groups",
                       balance.least == balance.most ? fmt::format("{}", balance.least)
                                                     : fmt::format("{} to {}", balance.least, balance.most));
  if (design.pairs && design.assignment == Assignment::Balanced)
    out += balance.interval_difference == 0
               ? std::string("; within each, the two orders of a pair come equally often")
               : fmt::format(
                     "; within each, the numbers of times that the two orders of a pair come differ by "
                     "at most {}",
                     balance.interval_difference);
  if (balance.even == 1) return out + "; any number divides evenly";
  if (balance.even_below == balance.planned) return out + "; divides evenly";
  out += fmt::format("; does not divide by {}: ", balance.even);
  if (balance.even_below > 0) out += fmt::format("{} or ", balance.even_below);
  return out + fmt::format("{} would", balance.even_above);
}

}  // namespace study
