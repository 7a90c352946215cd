/// Every call that SQLite makes on a file, failed or the last: whatever was acknowledged is there afterwards,
/// nothing twice and nothing changed, and the work can be finished.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <set>

#include "libstudy/session/interruptions.hpp"
#include "libstudy/store/export_bids.hpp"
#include "libstudy/store/export_csv.hpp"
#include "libstudy/store/journal_file.hpp"
#include "libstudy/store/merge.hpp"
#include "libstudy/store/salvage.hpp"
#include "libstudy/store/status.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/faults/content.hpp"
#include "tests/libstudy/fault_vfs.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using faults::Lines;
using faults::operator+;
using Kind = test::VfsFault::Kind;

/// What faults are tried on. `act` does the work, and when given again what is left of it.
struct Flow {
  const char* name;
  std::function<void(const fs::path&)> prepare;
  std::function<void(const fs::path&)> act;
  std::function<Lines(const fs::path&)> content;
  std::vector<const char*> healthy;  ///< databases that open before and must open afterwards
  const char* played = nullptr;      ///< whose answers are acknowledged in the file "said"
};

/// Survives the process, as a console's line does.
void acknowledge(const fs::path& folder, const UnitDone& done) {
  const int fd = ::open((folder / "said").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  const std::string line = done.participant + " " + std::to_string(done.unit.position) + "\n";
  EXPECT_EQ(::write(fd, line.data(), line.size()), static_cast<ssize_t>(line.size()));
  ::close(fd);
}

void run_open_sessions(const fs::path& folder, Store& store, const Protocol& protocol, int units) {
  PersonalFile personal(folder / "s.db");
  test::Scripted person;
  person.says["age"] = test::score(40);
  person.says["remarks"] = test::words("clear water");
  for (const OpenRun& run : store.open_runs()) {
    for (const OpenSession& session : run.sessions) {
      test::Desk desk(protocol);
      SessionParts parts = desk.parts(person, store);
      parts.personal = &personal;
      SessionHooks hooks;
      hooks.done = [&](const UnitDone& done) {
        acknowledge(folder, done);
        --units;
      };
      hooks.wish = [&] { return units > 0 ? Wish::GoOn : Wish::Stop; };
      run_session(protocol, session, parts, hooks);
    }
  }
}

/// Plans where nothing is planned, and goes through what is open, as run and resume do.
void play(const fs::path& folder, int units = 1000) {
  const Protocol protocol = test::paced_pairs();
  Store store(folder / "s.db", sqlite::Open::Create);
  if (read_status(folder / "s.db").sessions.empty()) store.add_run(test::run_plan(protocol, {"P01", "P02"}));
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
  RunPlan run = test::run_plan(test::pairs(), people);
  for (auto& session : run.sessions) session.station = station;
  store.add_run(run);
  PersonalFile personal(folder / name);
  const auto runs = store.open_runs();
  for (const OpenSession& session : runs.back().sessions) {
    test::answer_one(store, session, session.units.at(1), "ease", test::score(5));
    test::answer_one(store, session, session.units.back(), "remarks",
                     test::words("of " + session.plan.participant));
    personal.keep({{session.plan.participant, "age", "How old?", "33"}});
  }
}

/// P02 may be gone already. What cannot be cleaned is an error, as for the command.
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

std::function<void(const fs::path&)> fixture(const std::string& name) {
  return [=](const fs::path& folder) {
    fs::copy_file(base::resource("tests/libstudy/fixtures/" + name), folder / "s.db");
    fs::permissions(folder / "s.db", fs::perms::owner_read | fs::perms::owner_write);
  };
}

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
  };
}

Lines said_in(const fs::path& folder) {
  Lines all;
  if (!fs::exists(folder / "said")) return all;
  const std::string text = test::bytes_of(folder / "said");
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    all.push_back(text.substr(at, end - at));
  return all;
}

enum class How { WentOn, Refused, Stopped };

/// A flow that is tried again and again from one start.
class Trials {
 public:
  explicit Trials(const Flow& flow) : flow_(flow) {
    fs::create_directories(now_);
    flow.prepare(now_);
    fs::copy(now_, start_, fs::copy_options::recursive);
    vfs_.arm({});
    flow.act(now_);
    calls_ = vfs_.calls();
    wanted_ = flow.content(now_);
  }

  long calls() const { return calls_; }

  /// What is wrong after it; empty: nothing.
  std::string attempt(const test::VfsFault& fault, How& how) {
    fs::remove_all(now_);
    fs::copy(start_, now_, fs::copy_options::recursive);
    fs::create_directories(now_);
    try {
      how = fault.kind >= Kind::Stop ? act_in_child(fault) : act_here(fault);
      vfs_.disarm();
      if (how != How::WentOn) finish();
      const std::string differs = faults::difference(wanted_, flow_.content(now_));
      return differs.empty() ? "" : (how == How::WentOn ? "done, but" : "in the end") + differs;
    } catch (const std::exception& error) {
      vfs_.disarm();
      return error.what();
    }
  }

 private:
  How act_here(const test::VfsFault& fault) {
    vfs_.arm(fault);
    try {
      flow_.act(now_);
    } catch (const base::Error&) {
      return How::Refused;
    }
    return How::WentOn;
  }

  How act_in_child(const test::VfsFault& fault) {
    const pid_t child = ::fork();
    if (child == 0) {
      vfs_.arm(fault);
      try {
        flow_.act(now_);
      } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        ::_exit(1);
      }
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    if (!WIFEXITED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != test::stopped_status))
      throw std::runtime_error("the process ended with status " + std::to_string(status));
    return WEXITSTATUS(status) == 0 ? How::WentOn : How::Stopped;
  }

  /// What a user does then: looks, and gives the command again.
  void finish() {
    for (const char* name : flow_.healthy) read_status(now_ / name);
    Lines before;
    if (flow_.played) {
      const std::string lost = faults::missing(said_in(now_), faults::done_units(now_ / flow_.played));
      if (!lost.empty()) throw std::runtime_error("acknowledged and lost:" + lost);
      before = faults::answer_rows(now_ / flow_.played);
    }
    flow_.act(now_);
    if (!flow_.played) return;
    const std::string changed = faults::missing(before, faults::answer_rows(now_ / flow_.played));
    if (!changed.empty()) throw std::runtime_error("answers lost or changed:" + changed);
  }

  test::FaultVfs vfs_;
  const Flow& flow_;
  test::TemporaryFolder folder_{::test::memory_folder()};
  fs::path start_ = folder_ / "start", now_ = folder_ / "now";
  Lines wanted_;
  long calls_ = 0;
};

struct Named {
  Kind kind;
  const char* name;
};
constexpr Named kinds[] = {{Kind::Error, "error"},
                           {Kind::ErrorsOn, "errors from then on"},
                           {Kind::Full, "full"},
                           {Kind::FullOn, "full from then on"},
                           {Kind::Stop, "stop"},
                           {Kind::PowerCut, "power cut"},
                           {Kind::TornCut, "torn power cut"}};

/// Prints the table: of each of the flows and kinds of fault, how the tries of every `step`-th call ended.
void try_every(long step, const std::set<std::string>& names) {
  std::printf("%-22s %-20s %6s %8s %8s %8s %7s\n", "flow", "fault", "tries", "went on", "refused", "stopped",
              "failed");
  for (const Flow& flow : all_flows()) {
    if (!names.contains(flow.name)) continue;
    Trials trials(flow);
    long shift = 0;
    for (const auto& [kind, name] : kinds) {
      long ended[3] = {}, failed = 0, tried = 0;
      // Other calls for each kind, where not all are tried.
      for (long k = 1 + shift++ * step / std::ssize(kinds); k <= trials.calls(); k += step, ++tried) {
        How how = How::WentOn;
        const std::string problem = trials.attempt({kind, k}, how);
        if (problem.empty()) {
          ++ended[static_cast<int>(how)];
        } else if (++failed <= 3) {
          ADD_FAILURE() << flow.name << ", " << name << " at call " << k << ": " << problem;
        }
      }
      std::printf("%-22s %-20s %6ld %8ld %8ld %8ld %7ld\n", flow.name, name, tried, ended[0], ended[1],
                  ended[2], failed);
      std::fflush(stdout);
      EXPECT_EQ(failed, 0) << flow.name << ", " << name;
    }
  }
}

TEST(Faults, SomeCallsOfSessions) { try_every(97, {"session", "resume"}); }
TEST(Faults, SomeCallsOfExports) { try_every(31, {"export"}); }

TEST(Faults, SomeCallsOfSalvages) { try_every(41, {"salvage"}); }

TEST(Faults, SomeCallsOfWithdrawals) { try_every(67, {"withdrawal"}); }
TEST(Faults, SomeCallsOfMerges) { try_every(67, {"merge"}); }
TEST(Faults, SomeCallsOfUpgrades) { try_every(13, {"upgrade from schema 1", "upgrade from schema 2"}); }

TEST(FaultsSlow, EveryCallOfSessions) { try_every(1, {"session", "resume"}); }
TEST(FaultsSlow, EveryCallOfExports) { try_every(1, {"export"}); }
TEST(FaultsSlow, EveryCallOfWithdrawals) { try_every(1, {"withdrawal"}); }
TEST(FaultsSlow, EveryCallOfMerges) { try_every(1, {"merge"}); }
TEST(FaultsSlow, EveryCallOfSalvages) { try_every(1, {"salvage"}); }
TEST(FaultsSlow, EveryCallOfUpgrades) { try_every(1, {"upgrade from schema 1", "upgrade from schema 2"}); }

/// A disk that filled in the first commit of a new database leaves the plan in the journal alone. The next
/// run takes it over and is then refused, since the plan stands: it must not go with that run's new file.
TEST(Faults, PlanOfTheJournalOutlivesARefusedRun) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "s.db";
  const RunPlan plan = test::run_plan(test::pairs(), {"P01"});
  { Store(path, sqlite::Open::Create).add_run(plan); }
  fs::remove(path);
  const std::string journal = test::bytes_of(journal_beside(path));
  base::write_file_atomically(journal_beside(path), journal.substr(0, journal.rfind("{\"kept\"")));
  EXPECT_THROW(Store(path, sqlite::Open::Create).add_run(plan), base::Error);
  EXPECT_EQ(Store(path, sqlite::Open::Write).open_runs().size(), 1u);
}

/// The model itself: what was not synced is gone after a power cut, what was synced is there.
TEST(FaultVfs, PowerCutLosesWhatWasNotSynced) {
  const test::TemporaryFolder folder;
  test::FaultVfs vfs;
  const auto rows_after = [&](const char* synchronous) {
    const fs::path path = folder / (std::string(synchronous) + ".db");
    const pid_t child = ::fork();
    if (child == 0) {
      sqlite::Connection database(path, sqlite::Open::Create);
      database.execute("PRAGMA journal_mode = WAL; CREATE TABLE t (a); PRAGMA wal_checkpoint(TRUNCATE)");
      database.execute(std::string("PRAGMA synchronous = ") + synchronous);
      vfs.arm({Kind::PowerCut, 1000});
      database.execute("INSERT INTO t VALUES (1)");
      vfs.arm({Kind::PowerCut, 1});
      database.execute("INSERT INTO t VALUES (2)");
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), test::stopped_status);
    return sqlite::Connection(path, sqlite::Open::Read).integer("SELECT count(*) FROM t");
  };
  EXPECT_EQ(rows_after("FULL"), 1);
}

}  // namespace
}  // namespace study
