#pragma once
/// A study that asks its participants for permissions, for tests.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/file/database.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study::test {

/// A pilot of two settings with a consent page that asks gaze_kept, data_shared, both or neither.
inline Protocol asking_protocol(bool gaze = true, bool sharing = true) {
  std::string text = R"(
format = 2
name = "asking)" + std::string(gaze ? "" : "_no_gaze") +
                     (sharing ? "" : "_no_sharing") + R"("
version = "1.0"
language = "en"
participants = 4

[design]
scene = ["data/scenes/single_dam.toml"]
method = ["HiRes"]
n_star = ["16k"]
timing = "settings"
mean_fps = [20, 50]
sd_fps = [0]
duration_s = 0.5
order = "shuffle"

[pacing]
mean = "harmonic"
fps_min = 4
fps_max = "none"
max_interval_ms = 250
order = "white"

[content]
mode = "per_frame"
content_step_s = 0.02
start_frame = 0
at_end = "hold"

[[block]]
kind = "consent"
id = "consent"
text = "Read this."

[[block.question]]
id = "take_part"
kind = "choice"
text = "I take part."
anchors = {0 = "no", 1 = "yes"}
accept = [1, 1]
)";
  const auto box = [](const std::string& id) {
    return "\n[[block.question]]\nid = \"" + id +
           "\"\nkind = \"choice\"\ntext = \"May we?\"\nanchors = {0 = \"no\", 1 = \"yes\"}\n";
  };
  if (gaze) text += box(gaze_question);
  if (sharing) text += box(sharing_question);
  text += R"(
[[block]]
kind = "stimulus"
id = "trials"
steps = ["stimulus", "ask rating"]

[[block.question]]
id = "rating"
kind = "scale"
text = "How was it?"
scale = [1, 7]
)";
  return parse_protocol(text, "asking.toml");
}

/// Answers of a person on the consent page; none: not answered.
struct Says {
  std::string participant;
  std::optional<int> gaze, sharing;
};

/// Answers a session's consent page with what its protocol asks.
inline void answer_consent(Store& store, const OpenSession& session, const Says& says) {
  std::vector<KeptAnswer> kept{{"take_part", {score(1), 1}}};
  if (says.gaze) kept.push_back({gaze_question, {score(*says.gaze), 1}});
  if (says.sharing) kept.push_back({sharing_question, {score(*says.sharing), 1}});
  if (kept.size() > 1) store.answer(session.id, session.units.at(0), 0, kept, true, 900);
}

/// Adds sessions of these people, answers their consent pages and shows each their first trial.
inline void add_people(Store& store, const Protocol& protocol, const std::vector<Says>& people,
                       int visit = 1) {
  RunPlan run = run_plan(protocol, {});
  for (const Says& says : people) {
    run.sessions.push_back(session_plan(protocol, says.participant));
    run.sessions.back().visit = visit;
  }
  const std::int64_t id = store.add_run(run);
  for (const OpenRun& open : store.open_runs()) {
    for (std::size_t i = 0; open.id == id && i < people.size(); ++i) {
      answer_consent(store, open.sessions.at(i), people[i]);
      answer_one(store, open.sessions.at(i), open.sessions.at(i).units.at(1), "rating", score(5));
    }
  }
}

/// One column of a query's result as text, one line per row; "~" for null.
inline std::vector<std::string> column(const std::filesystem::path& path, const std::string& sql) {
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  std::vector<std::string> out;
  for (sqlite::Statement row(*database, sql); row.step();) out.push_back(row.is_null(0) ? "~" : row.text(0));
  return out;
}

/// "P01 gaze 1", ... with ~ for what the protocol does not ask.
inline std::vector<std::string> permissions_of(const std::filesystem::path& path) {
  return column(path,
                "SELECT participant || ' ' || what || ' ' || coalesce(granted, '~') FROM permission "
                "JOIN session USING (session_id) ORDER BY participant, visit, what");
}

/// P01 and P02 allow everything and have one gaze sample per visit; P01 has a second visit.
inline std::filesystem::path gaze_of_two(const TemporaryFolder& folder, double x = 0.5) {
  Store store(folder / "study.db", sqlite::Open::Create);
  add_people(store, asking_protocol(), {{"P01", 1, 1}, {"P02", 1, 1}});
  add_people(store, asking_protocol(), {{"P01", 1, 1}}, 2);
  for (const std::int64_t presentation : {1, 2, 3}) {
    const GazeSample sample{5, {}, true, GazePoint{presentation == 2 ? 0.125 : x, 0.5}};
    store.add_gaze(presentation, 0, GazeOrigin::Mouse, {&sample, 1});
  }
  return folder / "study.db";
}

/// Participant codes, one for each gaze sample.
inline std::vector<std::string> gaze_of(const std::filesystem::path& path) {
  return column(path,
                "SELECT participant FROM gaze JOIN presentation USING (presentation_id) "
                "JOIN trial USING (trial_id) JOIN session USING (session_id) ORDER BY 1");
}

}  // namespace study::test
