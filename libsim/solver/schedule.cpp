#include "libsim/solver/schedule.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace sim::SIM_BACKEND {

namespace {

std::vector<Stage>& phase_of(Schedule& schedule, Phase phase) {
  switch (phase) {
    case Phase::FrameStart:
      return schedule.frame_start;
    case Phase::Substep:
      return schedule.substep;
    case Phase::Iteration:
      return schedule.iteration;
    case Phase::SubstepEnd:
      return schedule.substep_end;
    case Phase::FrameEnd:
      break;
  }
  return schedule.frame_end;
}

/// The phases in the order of a frame.
template <class AnySchedule>
auto phases_of(AnySchedule& s) {
  return std::array{&s.frame_start, &s.substep, &s.iteration, &s.substep_end, &s.frame_end};
}

const char* phase_name(Phase phase) {
  switch (phase) {
    case Phase::FrameStart:
      return "frame start";
    case Phase::Substep:
      return "substep";
    case Phase::Iteration:
      return "iteration";
    case Phase::SubstepEnd:
      return "substep end";
    case Phase::FrameEnd:
      break;
  }
  return "frame end";
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size() + 1), ' ');
  return text;
}

void check_reads(const std::vector<Stage>& passes, ColumnSet& written) {
  for (const auto& pass : passes) {
    const ColumnSet missing = pass.reads - written;
    if (!missing.empty()) {
      throw base::Error(
          "schedule, pass '" + std::string(pass.name) + "'",
          std::string("reads the column ") + column_name(missing.first()) + ", which nothing has written",
          "add the stage that writes it");
    }
    written |= pass.writes;
  }
}

/// True if `later` may run before this pass: neither writes what the other accesses.
bool may_pass(const Stage& later, const Stage& pass) {
  return !pass.writes.meets(later.reads | later.writes) && !later.writes.meets(pass.reads);
}

/// Indices of two passes of a phase that can share a loop over neighbours, and the stage that replaces both.
struct Sharing {
  std::size_t first, second;
  Stage stage;
};
std::optional<Sharing> next_to_share(const std::vector<Stage>& passes, const std::vector<SharedLoop>& loops) {
  for (std::size_t i = 0; i < passes.size(); ++i)
    for (std::size_t j = i + 1; j < passes.size(); ++j)
      for (const SharedLoop& loop : loops) {
        if (passes[i].loop != loop.first || passes[j].loop != loop.second) continue;
        if (std::all_of(&passes[i], &passes[j], [&](const Stage& pass) { return may_pass(passes[j], pass); }))
          return Sharing{i, j, loop.stage};
      }
  return {};
}

/// Replaces two passes that can share a loop over neighbours by one pass in the place of the earlier pass,
/// until no two passes can share a loop.
void share_loops(std::vector<Stage>& passes, const std::vector<SharedLoop>& loops, std::string& explanation) {
  while (auto sharing = next_to_share(passes, loops)) {
    explanation += "  one loop     " + padded(sharing->stage.name, 20) + "instead of " +
                   passes[sharing->first].name + " and " + passes[sharing->second].name + "\n";
    sharing->stage.effect = passes[sharing->first].effect;
    passes[sharing->first] = sharing->stage;
    passes.erase(passes.begin() + static_cast<std::ptrdiff_t>(sharing->second));
  }
}

void run_all(const std::vector<Stage>& passes, FluidState& state) {
  for (const auto& pass : passes) {
    state.clock.enter(pass.part);
    state.pass_clock.enter(pass.place);
    pass.run(state);
    state.impulse.mark(pass.changes, state.particles, state.guard());
  }
}

const Effect* listed(const Demand& demand, EffectKind kind) {
  for (const Effect& effect : demand.effects)
    if (effect.kind == kind) return &effect;
  return nullptr;
}

std::string reason_for(const Stage& stage, const Demand& demand) {
  if (stage.effect == no_effect) return stage.called_for(demand);
  const Effect* effect = listed(demand, stage.effect);
  if (!acts(demand, stage.effect)) return "";
  if (stage.called_for && stage.called_for(demand).empty()) return "";
  return std::string("the scene lists ") + traits_of(effect->kind).key + " = " +
         base::shortest(effect->coefficient);
}

std::string why_not(const Stage& stage, const Demand& demand) {
  if (stage.called_for == if_activation && demand.keeps_all_solved != no_effect)
    return std::string("no particle rests where the effect ") + traits_of(demand.keeps_all_solved).word +
           " acts";
  const Effect* effect = stage.effect == no_effect ? nullptr : listed(demand, stage.effect);
  if (!effect) return "not called for";
  if (effect->coefficient == 0)
    return std::string("dropped: the scene lists ") + traits_of(effect->kind).key + " = 0";
  if (!is_idle(*effect, demand.effects, demand.finest_level)) return "not called for";
  const int coarsest = static_cast<int>(coefficients_of(demand.effects)[*coarsest_level_of(effect->kind)]);
  return std::string("idle: ") + traits_of(effect->kind).word + " is for level " +
         (coarsest > 0 ? "0 to " : "") + std::to_string(coarsest) + ", and no water is so fine";
}

}  // namespace

Schedule compile_schedule(const Demand& demand, const std::vector<Stage>& stages,
                          const std::vector<SharedLoop>& loops) {
  Schedule out;
  std::string absent;
  out.columns = columns(Column::Position, Column::Velocity, Column::Id, Column::Level);
  // Columns that have values before the first pass: creating a particle sets them.
  ColumnSet written = out.columns | columns(Column::Target, Column::History, Column::Drift) | ruled_columns();
  for (const auto& stage : stages) {
    const std::string reason = reason_for(stage, demand);
    if (reason.empty()) {
      absent += "  -  " + padded(stage.name, 20) + why_not(stage, demand) + "\n";
      continue;
    }
    phase_of(out, stage.phase).push_back(stage);
    out.columns |= stage.reads | stage.writes;
    out.explanation += "  " + padded(phase_name(stage.phase), 13) + padded(stage.name, 20) +
                       padded(reason, 40) + stage.source + "\n";
  }
  out.activation_paused = demand.keeps_all_solved != no_effect;
  if (out.activation_paused) out.columns |= columns(Column::Active, Column::StartCell);
  for (auto* passes : {&out.substep, &out.iteration, &out.substep_end})
    share_loops(*passes, loops, out.explanation);
  for (auto* passes : phases_of(out)) {
    check_reads(*passes, written);
    for (Stage& pass : *passes) pass.place = out.passes++;
  }
  out.explanation += absent + "  columns:";
  for (ColumnSet left = out.columns; !left.empty(); left = left - columns(left.first()))
    out.explanation += std::string(" ") + column_name(left.first());
  out.explanation += "\n";
  return out;
}

std::vector<StageTime> stage_times(const Schedule& schedule, const PassClock& clock) {
  std::vector<StageTime> out;
  for (const auto* passes : phases_of(schedule))
    for (const Stage& pass : *passes)
      out.push_back({pass.name, phase_name(pass.phase), pass.effect, clock.milliseconds(pass.place)});
  return out;
}

void run_frame(const Schedule& schedule, FluidState& state) {
  state.clock.start_frame();
  state.pass_clock.start_frame();
  state.impulse.begin_frame(state.particles, state.guard());
  state.obstacles.begin_frame();
  state.substep = 0;
  if (schedule.activation_paused) state.activation.columns_set = false;
  run_all(schedule.frame_start, state);
  for (int substep = 0; substep < state.parameters.substeps; ++substep) {
    state.begin_substep(substep);
    run_all(schedule.substep, state);
    for (int iteration = 0; iteration < state.parameters.iterations; ++iteration) {
      state.iteration = iteration;
      run_all(schedule.iteration, state);
    }
    run_all(schedule.substep_end, state);
  }
  run_all(schedule.frame_end, state);
  state.clock.end_frame();
  state.pass_clock.end_frame();
}

}  // namespace sim::SIM_BACKEND
