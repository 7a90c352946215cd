#pragma once
/// A small study in a temporary folder, for tests of the store and the session.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace study::test {

using ::test::TemporaryFolder;

inline std::string bytes_of(const std::filesystem::path& path) { return base::read_file(path, 1u << 30); }

inline Protocol pilot() { return read_protocol(base::resource("protocols/ptpe_pilot.toml")); }

inline SessionPlan session_plan(const Protocol& protocol, const std::string& participant,
                                std::uint64_t seed = 7) {
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
  plan.trials = make_plan(protocol, participant, seed);
  return plan;
}

inline RunPlan run_plan(const Protocol& protocol, const std::vector<std::string>& participants) {
  RunPlan run{protocol, "{}", {}};
  for (const auto& participant : participants) run.sessions.push_back(session_plan(protocol, participant));
  return run;
}

/// Frames of 20 ms from start_ns on, with everything known that a display can know.
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
    frame.facts.active_fraction = 0.75;
    frame.facts.tolerance = -2.5;
    all.push_back(frame);
  }
  return all;
}

}  // namespace study::test
