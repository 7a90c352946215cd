#include "tests/libstudy/fault_flows.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "libstudy/session/interruptions.hpp"
#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/withdraw.hpp"
#include "tests/libstudy/permission_fixture.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study::test {
namespace {

using faults::operator+;

/// Writes an acknowledgement that survives the process, like a line on the console.
void acknowledge(const fs::path& folder, const UnitDone& done) {
  const int fd = ::open((folder / "said").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  const std::string line = done.participant + " " + std::to_string(done.unit.position) + "\n";
  EXPECT_EQ(::write(fd, line.data(), line.size()), static_cast<ssize_t>(line.size()));
  ::close(fd);
}

void run_open_sessions(const fs::path& folder, Store& store, const Protocol& protocol, int units) {
  PersonalFile personal(folder / "s.db");
  Scripted person;
  person.says["age"] = score(40);
  person.says["remarks"] = words("clear water");
  for (const OpenRun& run : store.open_runs()) {
    for (const OpenSession& session : run.sessions) {
      Desk desk(protocol);
      SessionParts parts = desk.parts(person, store);
      parts.personal = &personal;
      SessionHooks hooks;
      hooks.done = [&](const UnitDone& done) {
        acknowledge(folder, done);
        --units;
      };
      hooks.request = [&] { return units > 0 ? Request::GoOn : Request::Stop; };
      run_session(protocol, session, parts, hooks);
    }
  }
}

/// Plans sessions if there are none, and plays the open ones, like the commands run and resume.
void play(const fs::path& folder, int units = 1000) {
  const Protocol protocol = paced_pairs();
  Store store(folder / "s.db", sqlite::Open::Create);
  if (read_status(folder / "s.db").sessions.empty()) store.add_run(run_plan(protocol, {"P01", "P02"}));
  for (const OpenRun& run : store.open_runs())
    for (const OpenSession& session : run.sessions) settle_interruption(store, protocol, session);
  run_open_sessions(folder, store, protocol, units);
}

void play_half(const fs::path& folder) {
  try {
    play(folder, 4);
  } catch (const Stopped&) {
  }
}

Lines played_content(const fs::path& folder) {
  return faults::session_content(folder / "s.db") + faults::personal_content(folder / "s.db");
}

Lines whole_content(const fs::path& folder, const char* name) {
  return faults::database_content(folder / name) + faults::personal_content(folder / name);
}

void whole_study(const fs::path& folder, const char* name, const std::vector<std::string>& people,
                 const char* station) {
  Store store(folder / name, sqlite::Open::Create);
  RunPlan run = run_plan(pairs(), people);
  for (auto& session : run.sessions) session.station = station;
  store.add_run(run);
  PersonalFile personal(folder / name);
  const auto runs = store.open_runs();
  for (const OpenSession& session : runs.back().sessions) {
    answer_one(store, session, session.units.at(1), "ease", score(5));
    answer_one(store, session, session.units.back(), "remarks", words("of " + session.plan.participant));
    personal.keep({{session.plan.participant, "age", "How old?", "33"}});
  }
}

/// P02 may be gone already. Throws if a file cannot be cleaned, like the command.
void withdraw_P02(const fs::path& folder, const char* name) {
  if (faults::database_content(folder / name).empty()) return;
  check_nothing_left(folder / name, withdraw(folder / name, "P02").beside.left);
}

void stations(const fs::path& folder) {
  whole_study(folder, "north.db", {"P01", "P02"}, "north");
  whole_study(folder, "south.db", {"P01", "P03"}, "south");
  for (const char* beside : {"", ".personal"})
    fs::copy_file(folder / ("north.db" + std::string(beside)), folder / ("all.db" + std::string(beside)));
  withdraw_P02(folder, "north.db");
}

/// Two people who allow everything, each with one gaze sample.
void looked_at(const fs::path& folder) {
  Store store(folder / "s.db", sqlite::Open::Create);
  add_people(store, asking_protocol(), {{"P01", 1, 1}, {"P02", 1, 1}});
  for (const std::int64_t presentation : {1, 2}) {
    const GazeSample sample{5, {}, true, GazePoint{.5, .5}};
    store.add_gaze(presentation, 0, GazeOrigin::Mouse, {&sample, 1});
  }
}

Lines allowed_and_looked_at(const fs::path& folder) {
  Lines all =
      column(folder / "s.db", "SELECT 'gaze of presentation ' || presentation_id FROM gaze ORDER BY 1");
  return all + faults::permission_content(folder / "s.db") + faults::answer_rows(folder / "s.db");
}

std::function<void(const fs::path&)> fixture(const std::string& name) {
  return [=](const fs::path& folder) {
    fs::copy_file(base::resource("tests/libstudy/fixtures/" + name), folder / "s.db");
    fs::permissions(folder / "s.db", fs::perms::owner_read | fs::perms::owner_write);
  };
}

}  // namespace

std::vector<Flow> all_flows() {
  const auto one = [](const fs::path& folder) {
    whole_study(folder, "s.db", {"P01", "P02", "P03"}, "north");
  };
  return {
      {"session",
       [](const fs::path&) {},
       [](const fs::path& folder) { play(folder); },
       played_content,
       {},
       "s.db"},
      {"resume", play_half, [](const fs::path& folder) { play(folder); }, played_content, {"s.db"}, "s.db"},
      {"withdrawal",
       one,
       [](const fs::path& folder) { withdraw_P02(folder, "s.db"); },
       [](const fs::path& folder) { return whole_content(folder, "s.db"); },
       {"s.db"}},
      {"consent",
       looked_at,
       [](const fs::path& folder) {
         const auto done = change_permissions(folder / "s.db", "P02", {.gaze = false, .sharing = false});
         check_nothing_left(folder / "s.db", done.left);
       },
       allowed_and_looked_at,
       {"s.db"}},
      {"merge",
       stations,
       [](const fs::path& folder) {
         const Merge done = merge({folder / "north.db", folder / "south.db"}, folder / "all.db");
         check_nothing_left(folder / "all.db", done.beside.left);
       },
       [](const fs::path& folder) {
         return whole_content(folder, "all.db") + whole_content(folder, "north.db") +
                whole_content(folder, "south.db");
       },
       {"north.db", "south.db", "all.db"}},
      {"export",
       one,
       [](const fs::path& folder) {
         export_csv(folder / "s.db", folder / "csv");
         export_bids(folder / "s.db", folder / "bids");
       },
       [](const fs::path& folder) {
         return faults::folder_content(folder / "csv") + faults::folder_content(folder / "bids");
       },
       {"s.db"}},
      {"salvage",
       [](const fs::path& folder) {
         play(folder);
         fs::resize_file(folder / "s.db", fs::file_size(folder / "s.db") / 2);
       },
       [](const fs::path& folder) {
         if (!fs::exists(folder / "new.db")) salvage(folder / "s.db", folder / "new.db");
         read_status(folder / "new.db");
       },
       [](const fs::path& folder) { return faults::answer_rows(folder / "new.db"); },
       {}},
      {"upgrade from schema 1",
       fixture("study_v1.db"),
       [](const fs::path& folder) { Store(folder / "s.db", sqlite::Open::Write); },
       [](const fs::path& folder) { return faults::database_content(folder / "s.db"); },
       {"s.db"}},
      {"upgrade from schema 2",
       fixture("study_v2.db"),
       [](const fs::path& folder) { Store(folder / "s.db", sqlite::Open::Write); },
       [](const fs::path& folder) { return faults::database_content(folder / "s.db"); },
       {"s.db"}},
      {"upgrade from schema 3",
       fixture("study_v3.db"),
       [](const fs::path& folder) { Store(folder / "s.db", sqlite::Open::Write); },
       [](const fs::path& folder) { return faults::database_content(folder / "s.db"); },
       {"s.db"}},
      {"upgrade from schema 4",
       fixture("study_v4.db"),
       [](const fs::path& folder) { Store(folder / "s.db", sqlite::Open::Write); },
       [](const fs::path& folder) { return faults::database_content(folder / "s.db"); },
       {"s.db"}},
      {"upgrade from schema 5",
       fixture("study_v5.db"),
       [](const fs::path& folder) { Store(folder / "s.db", sqlite::Open::Write); },
       [](const fs::path& folder) { return faults::database_content(folder / "s.db"); },
       {"s.db"}},
  };
}

}  // namespace study::test
