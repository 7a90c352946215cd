#pragma once
/// A database whose sessions were shown with the light patch, on the real clock.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/libstudy/light_fixture.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study::test {

/// Stores a pilot whose first trials were shown at the onsets of `showings`, as submitted by the program, and
/// answered. options: of the run. resumed_before: the showing before which the program began anew. Returns
/// the session.
inline std::int64_t lit_study(const std::filesystem::path& path, const std::vector<RecordedShowing>& showings,
                              const std::string& participant = "P01",
                              const std::string& options = R"({"format":2,"light_patch":true})",
                              int resumed_before = -1) {
  Store store(path, sqlite::Open::Create);
  RunPlan run = run_plan(pilot(), {participant});
  run.options = options;
  run.sessions.at(0).virtual_clock = false;
  const std::int64_t id = store.add_run(run);
  for (const OpenRun& open : store.open_runs()) {
    if (open.id != id) continue;
    const OpenSession& session = open.sessions.at(0);
    auto showing = showings.begin();
    for (const OpenUnit& unit : session.units) {
      if (!unit.trial) continue;
      if (showing == showings.end()) break;
      if (showing - showings.begin() == resumed_before) store.log(session.id, "resumed", "", 0);
      const std::int64_t start_ns = showing->onsets_ns.front() - 1'000'000;
      const std::int64_t row =
          store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, start_ns);
      std::vector<FrameRecord> shown = frames(start_ns, static_cast<std::int64_t>(showing->onsets_ns.size()));
      for (std::size_t i = 0; i < shown.size(); ++i) {
        shown[i].scheduled_ns = showing->onsets_ns[i] - 1000;
        shown[i].times = {};
        shown[i].times.submitted_ns = showing->onsets_ns[i];
      }
      TimingVerdict judged = verdict();
      judged.grade = TimingGrade::CpuSubmit;
      store.end_presentation(row, start_ns, showing->onsets_ns.back() + 20'000'000, shown, judged);
      const KeptAnswer kept{"satisfaction", {score(4), 1.5}};
      store.answer(session.id, unit, 1, {&kept, 1}, true, 900);
      ++showing;
    }
    return session.id;
  }
  return 0;
}

}  // namespace study::test
