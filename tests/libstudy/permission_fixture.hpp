#pragma once
/// A study that asks its participants for permissions, for tests.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/file/database.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study::test {

inline Protocol asking_protocol(bool gaze = true, bool sharing = true) {
  return parse_protocol(asking_text(gaze, sharing), "asking.toml");
}

/// A person's answers on the consent page; an empty one was not given.
struct Says {
  std::string participant;
  std::optional<int> gaze, sharing;
};

/// Answers a session's consent page: yes to taking part, and the permissions in `says`. Without a permission
/// in `says` the page stays open.
inline void answer_consent(Store& store, const OpenSession& session, const Says& says) {
  std::vector<KeptAnswer> kept{{"take_part", {score(1), 1}}};
  if (says.gaze) kept.push_back({gaze_question, {score(*says.gaze), 1}});
  if (says.sharing) kept.push_back({sharing_question, {score(*says.sharing), 1}});
  if (kept.size() > 1) store.answer(session.id, session.units.at(0), 0, kept, true, 900);
}

/// Adds sessions of these people, answers their consent pages and plays each first trial, which is rated 5.
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

/// One column of a query's result as text; "~" stands for null.
inline std::vector<std::string> column(const std::filesystem::path& path, const std::string& sql) {
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  std::vector<std::string> out;
  for (sqlite::Statement row(*database, sql); row.step();) out.push_back(row.is_null(0) ? "~" : row.text(0));
  return out;
}

/// Lines such as "P01 gaze 1", with "~" for a permission that was never asked for or changed.
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
