#pragma once
/// A small study in a temporary folder, for tests of the store and the session.

#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/protocols.hpp"
#include "tests/common/temporary_folder.hpp"

namespace study::test {

using namespace ::test;

inline std::string bytes_of(const std::filesystem::path& path) { return base::read_file(path, 1u << 30); }

/// The error of this protocol's text, read as own.toml; "no error" if it is accepted.
inline std::string error_of_protocol(const std::string& text) {
  try {
    parse_protocol(text, "own.toml");
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

inline Protocol pilot() { return read_protocol(base::resource("protocols/ptpe_pilot.toml")); }

inline SessionPlan session_plan(const Protocol& protocol, const std::string& participant,
                                std::uint64_t seed = 7, int slot = 0) {
  SessionPlan plan;
  plan.participant = participant;
  plan.seed = seed;
  plan.test_data = protocol.test_data;
  plan.observer = "ptpe:a=31,b=0.035";
  plan.virtual_clock = true;
  plan.display = "none";
  plan.stimulus = "none";
  plan.machine = "test";
  plan.time_zone = "UTC";
  plan.station = "north";
  std::vector<int> cells(protocol.design.cells.size());
  std::iota(cells.begin(), cells.end(), 0);
  const std::string& scene = protocol.design.cells.front().stimulus.scene;
  plan.framing = {{scene, 640, 360, 640, 360, 75, 27.0, cells, {}, "test"}};
  plan.plan = make_plan(protocol, participant, seed, slot);
  return plan;
}

inline RunPlan run_plan(const Protocol& protocol, const std::vector<std::string>& participants) {
  RunPlan run{protocol, "{}", {}};
  for (const auto& participant : participants) run.sessions.push_back(session_plan(protocol, participant));
  return run;
}

inline Protocol pairs() { return parse_protocol(pairs_text(), "pairs.toml"); }

inline TimingVerdict verdict() {
  TimingVerdict verdict;
  verdict.verdict = Verdict::Degraded;
  verdict.grade = TimingGrade::DisplayFeedback;
  verdict.nominal = {50, 5, 1};
  verdict.realised = {40, 49.5, 50.5, 3.25};
  verdict.longest_ms = 41;
  verdict.shortest_ms = 11;
  verdict.p95_ms = 31;
  verdict.lag1 = -0.125;
  verdict.late = 1;
  verdict.worst_late_ms = 2.5;
  verdict.reason = "one frame late";
  return verdict;
}

/// Frames of 20 ms from start_ns on, with all the facts that a display can report.
inline std::vector<FrameRecord> frames(std::int64_t start_ns, std::int64_t count) {
  std::vector<FrameRecord> all;
  for (std::int64_t i = 0; i < count; ++i) {
    FrameRecord frame;
    frame.index = i;
    frame.content_step = 5 + i;
    frame.scheduled_ns = start_ns + 20'000'000 * i;
    frame.times.submitted_ns = frame.scheduled_ns + 1000 + i;
    frame.times.gpu_done_ns = frame.scheduled_ns + 2000;
    frame.late = i == 3;
    frame.facts.simulation_time_s = 0.1 * static_cast<double>(i);
    frame.facts.particles_by_level = {100, 800};
    frame.facts.tolerance = FrameTolerance{-2.5, 0.875, 0.75, 18, 4};
    frame.facts.guards = FrameGuards{1, 2, 3, 4, 5, 6, 7, 8};
    all.push_back(frame);
  }
  return all;
}

/// Shows a trial's stimuli once more. Returns the number of the attempt, from 1.
inline int show(Store& store, const OpenSession& session, const OpenUnit& unit, std::int64_t count = 40) {
  const std::int64_t start_ns = 1'000'000'000'000;
  const int attempt = unit.attempts + 1;
  std::vector<int> cells{unit.trial->first};
  if (unit.trial->second) cells.push_back(*unit.trial->second);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto id =
        store.begin_presentation(session.id, unit.trial_id, attempt, static_cast<int>(i), cells[i], start_ns);
    store.end_presentation(id, start_ns, start_ns + 20'000'000 * count, frames(start_ns, count), verdict());
  }
  return attempt;
}

inline Answer words(const std::string& text) { return {{}, text}; }
inline Answer score(int value) { return {value, {}}; }

/// Shows the unit if it is a trial, answers one question, and ends the unit.
inline void answer_one(Store& store, const OpenSession& session, const OpenUnit& unit,
                       const std::string& question, const Answer& answer) {
  const int attempt = unit.trial ? show(store, session, unit) : 0;
  const KeptAnswer kept{question, {answer, 1.5}};
  store.answer(session.id, unit, attempt, {&kept, 1}, true, 900);
}

/// Finishes all open units of a pilot's session, every trial with the same score.
inline void finish_pilot(Store& store, const OpenSession& session, int satisfaction) {
  for (const OpenUnit& unit : session.units) {
    if (unit.trial)
      answer_one(store, session, unit, "satisfaction", score(satisfaction));
    else
      store.finish_unit(session.id, unit.id, 900);
  }
}

}  // namespace study::test
