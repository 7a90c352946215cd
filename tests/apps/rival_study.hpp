#pragma once
/// Databases of finished pilots with the record of every frame, for the comparison of timing models.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "libstudy/analysis/timing_predictors.hpp"
#include "libstudy/pacing/schedule.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/file.hpp"
#include "tests/common/protocols.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace rival_study {

/// The frames of a schedule, each shown on time.
inline study::PlayedTrial played_exactly(const study::Schedule& schedule, std::int64_t start_ns) {
  study::PlayedTrial out;
  std::int64_t due = start_ns;
  for (const std::int64_t interval : schedule.intervals_ns) {
    study::FrameRecord& frame = out.frames.emplace_back();
    frame.index = static_cast<std::int64_t>(out.frames.size()) - 1;
    frame.scheduled_ns = frame.times.submitted_ns = due;
    due += interval;
  }
  out.end_ns = due;
  return out;
}

/// The score (1 to 7) of a person, from 0, who saw frames with these predictors.
using Score = std::function<int(int person, const study::TimingPredictors&)>;

/// Text of the shipped pilot with trials of 2 s.
inline std::string protocol_text() {
  return test::with_keys(base::read_file(base::resource("protocols/ptpe_pilot.toml"), 1 << 20),
                         {{"duration_s", "2"}});
}

/// A finished pilot of the paper's 21 settings, 2 s each. `record`: false leaves the frames out of the
/// record.
/// `error_ms`: animation error that is recorded, by the number of the trial; none: not recorded.
inline void write(const std::filesystem::path& path, int people, const Score& score, bool record = true,
                  const std::function<double(int trial)>& error_ms = {}) {
  const auto protocol = study::parse_protocol(protocol_text(), "pilot.toml");
  std::vector<std::string> codes;
  for (int p = 0; p < people; ++p) codes.push_back("P" + std::to_string(p + 1));
  study::Store store(path, study::sqlite::Open::Create);
  store.add_run(study::test::run_plan(protocol, codes));
  const auto runs = store.open_runs();
  for (const auto& session : runs.at(0).sessions) {
    const int person = std::stoi(session.plan.participant.substr(1)) - 1;
    for (const auto& unit : session.units) {
      if (!unit.trial) {
        store.finish_unit(session.id, unit.id, 0);
        continue;
      }
      const auto& setting = protocol.design.cells.at(static_cast<std::size_t>(unit.trial->first)).setting;
      const std::int64_t start_ns = 1'000'000'000;
      const auto played = played_exactly(study::compile_schedule(setting, protocol.pacing, 1), start_ns);
      auto verdict = study::judge_trial(setting, protocol.pacing, played, protocol.timing,
                                        study::TimingGrade::CpuSubmit);
      if (error_ms) verdict.animation_error_ms = error_ms(unit.plan.position);
      const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, start_ns);
      store.end_presentation(id, start_ns, played.end_ns,
                             record ? played.frames : std::vector<study::FrameRecord>(), verdict);
      const auto at = study::timing_predictors(study::realised_intervals(played, verdict.grade),
                                               verdict.animation_error_ms);
      const study::KeptAnswer kept{"satisfaction", {{score(person, at), ""}, 1}};
      store.answer(session.id, unit, 1, {&kept, 1}, true, 2);
    }
  }
}

}  // namespace rival_study
