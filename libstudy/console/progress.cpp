#include "libstudy/console/progress.hpp"

#include <algorithm>
#include <sstream>

#include "libstudy/session/participant.hpp"

namespace study {

namespace {

using study::BlockKind;
using study::StepKind;

double reading_s(const std::string& text) {
  std::istringstream all(text);
  int words = 0;
  for (std::string word; all >> word;) ++words;
  return words / 3.5;
}

const Block& block_of(const Protocol& protocol, const OpenUnit& unit) {
  return protocol.blocks.at(static_cast<std::size_t>(unit.plan.block));
}

std::size_t cell_of(const PlannedTrial& trial, int interval) {
  return static_cast<std::size_t>(interval == 0 ? trial.first : trial.second.value_or(trial.first));
}

double trial_s(const Protocol& protocol, const OpenUnit& unit, bool person,
               std::span<const double> showing_s) {
  const auto shown_s = [&](std::size_t cell) {
    return showing_s.empty() ? protocol.design.cells.at(cell).setting.duration_s : showing_s[cell];
  };
  double total = 0;
  for (const TrialStep& step : block_of(protocol, unit).steps) {
    if (step.kind == StepKind::Black || step.kind == StepKind::Rest) total += step.seconds;
    if (step.kind == StepKind::Stimulus)
      total +=
          shown_s(cell_of(*unit.trial, step.interval)) + (unit.trial->second ? word_s + after_word_s : 0);
    if (step.kind == StepKind::Ask && person) total += 5 * static_cast<double>(step.asks.size());
  }
  return total;
}

}  // namespace

double expected_s(const Protocol& protocol, const OpenUnit& unit, bool person,
                  std::span<const double> showing_s) {
  if (unit.trial) return trial_s(protocol, unit, person, showing_s);
  const Block& block = block_of(protocol, unit);
  switch (block.kind) {
    case BlockKind::Rest:
    case BlockKind::Break:
    case BlockKind::Black:
      return block.seconds;
    case BlockKind::Stimulus:
      return block.between_groups_s + block.break_s;
    default: {
      if (!person) return block.seconds;
      double total = std::max(block.seconds, reading_s(block.text));
      for (const Question& question : block.questions)
        total += reading_s(question.text) + traits_of(question.kind).answering_s;
      return total;
    }
  }
}

double expected_s(const Protocol& protocol, std::span<const OpenUnit> units, bool person,
                  std::span<const double> showing_s) {
  double total = 0;
  for (const OpenUnit& unit : units) total += expected_s(protocol, unit, person, showing_s);
  return total;
}

std::uint64_t expected_bytes(const Protocol& protocol, std::span<const OpenUnit> units) {
  double frames = 0;
  for (const OpenUnit& unit : units) {
    if (!unit.trial) continue;
    for (const TrialStep& step : block_of(protocol, unit).steps) {
      if (step.kind != StepKind::Stimulus) continue;
      const FpsSetting& setting = protocol.design.cells.at(cell_of(*unit.trial, step.interval)).setting;
      frames += setting.duration_s *
                (setting.mean > 0 ? setting.mean : 60);  // without a schedule: assume 60 frames/s
    }
  }
  return static_cast<std::uint64_t>(64 * frames + 4096 * static_cast<double>(units.size()));
}

}  // namespace study
