#pragma once
/// Databases of Task 1 and Task 2 with any trials and answers.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/store.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace task_database {

/// One planned trial: scene, n_* and methods as the protocol names them.
struct Trial {
  std::string participant;
  int visit = 1, position = 0;
  std::string scene, n_star, first;
  std::optional<std::string> second;
  std::map<std::string, int> answers;  ///< by question; empty: never shown
};

inline int cell_of(const study::Protocol& protocol, const Trial& trial, const std::string& method) {
  const auto& cells = protocol.design.cells;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto& what = cells[i].stimulus;
    if (what.scene == trial.scene && what.n_star == trial.n_star && what.method == method)
      return static_cast<int>(i);
  }
  throw std::invalid_argument("trial of " + trial.participant + ": the protocol shows no " + method + " in " +
                              trial.scene + " at " + trial.n_star + "; use one of its cells");
}

/// Sessions by participant and visit, in the order of `trials`; each trial is a unit of the first block that
/// shows stimuli.
inline std::vector<study::SessionPlan> sessions(const study::Protocol& protocol,
                                                const std::vector<Trial>& trials) {
  int block = 0;
  while (protocol.blocks.at(static_cast<std::size_t>(block)).kind != study::BlockKind::Stimulus) ++block;
  std::vector<study::SessionPlan> out;
  for (const Trial& trial : trials) {
    if (out.empty() || out.back().participant != trial.participant || out.back().visit != trial.visit) {
      out.push_back(study::test::session_plan(protocol, trial.participant));
      out.back().visit = trial.visit;
      out.back().observer.reset();
      out.back().test_data = false;
      out.back().plan.units.clear();
      out.back().plan.trials.clear();
    }
    auto& plan = out.back().plan;
    study::PlannedTrial planned;
    planned.position = trial.position;
    planned.block = block;
    planned.first = cell_of(protocol, trial, trial.first);
    if (trial.second) planned.second = cell_of(protocol, trial, *trial.second);
    plan.trials.push_back(planned);
    plan.units.push_back({trial.position, block, trial.position});
  }
  return out;
}

/// Stores a showing that passes the timing check.
inline void show(study::Store& store, std::int64_t session, const study::OpenUnit& unit, int interval,
                 int cell) {
  const auto id = store.begin_presentation(session, unit.trial_id, 1, interval, cell, 0);
  study::TimingVerdict verdict;
  verdict.verdict = study::Verdict::Pass;
  verdict.realised = {900, 30, 30, 9};
  store.end_presentation(id, 0, 1, {}, verdict);
}

inline void write(const std::filesystem::path& path, const study::Protocol& protocol,
                  std::vector<Trial> trials) {
  study::Store store(path, study::sqlite::Open::Create);
  store.add_run({protocol, "{}", sessions(protocol, trials)});
  const auto runs = store.open_runs();
  for (const auto& session : runs.at(0).sessions) {
    for (const auto& unit : session.units) {
      for (const Trial& trial : trials) {
        if (trial.participant != session.plan.participant || trial.visit != session.plan.visit ||
            trial.position != unit.trial->position || trial.answers.empty())
          continue;
        show(store, session.id, unit, 0, unit.trial->first);
        if (unit.trial->second) show(store, session.id, unit, 1, *unit.trial->second);
        std::vector<study::KeptAnswer> kept;
        for (const auto& [question, score] : trial.answers) kept.push_back({question, {{score, ""}, 1}});
        store.answer(session.id, unit, 1, kept, true, 2);
      }
    }
  }
}

}  // namespace task_database
