#pragma once
/// Databases of finished pilots, with answers from any function of what was shown.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "libstudy/observer/ptpe_observer.hpp"
#include "libstudy/store/store.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace testing_pilot {

using Score = std::function<int(const study::Question&, const study::Occasion&)>;

/// Verdict of a showing exactly at the cell's nominal setting.
inline study::TimingVerdict shown_exactly(const study::FpsSetting& setting) {
  study::TimingVerdict verdict;
  verdict.verdict = study::Verdict::Pass;
  verdict.nominal = setting;
  verdict.realised = {static_cast<std::size_t>(10 * setting.mean), setting.mean, setting.mean, setting.sd};
  return verdict;
}

/// A finished pilot of the paper's 21 settings.
inline void write_database(const std::filesystem::path& path, const Score& score,
                           const std::vector<std::string>& participants = {"P1", "P2", "P3", "P4", "P5",
                                                                           "P6"}) {
  const auto protocol = study::test::pilot();
  const study::Question& question = protocol.blocks.at(2).questions.at(0);
  study::Store store(path, study::sqlite::Open::Create);
  store.add_run(study::test::run_plan(protocol, participants));
  const auto runs = store.open_runs();
  for (const auto& session : runs.at(0).sessions) {
    for (const auto& unit : session.units) {
      if (!unit.trial) {
        store.finish_unit(session.id, unit.id, 0);
        continue;
      }
      const study::Cell& cell = protocol.design.cells.at(static_cast<std::size_t>(unit.trial->first));
      const auto verdict = shown_exactly(cell.setting);
      const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, 0);
      store.end_presentation(id, 0, 1, {}, verdict);
      study::Occasion occasion{
          session.plan.participant, 8, unit.plan.position, study::BlockKind::Stimulus, {}};
      occasion.shown.push_back({unit.trial->first, cell, verdict.realised, 0, 0});
      const study::KeptAnswer kept{question.id, {{score(question, occasion), ""}, 1}};
      store.answer(session.id, unit, 1, {&kept, 1}, true, 2);
    }
  }
}

inline Score simulated(const std::string& specification) {
  return [observer = study::PtpeObserver(study::parse_ptpe_observer(specification))](
             const study::Question& question, const study::Occasion& occasion) {
    return observer.score(question, occasion, true);
  };
}

}  // namespace testing_pilot
