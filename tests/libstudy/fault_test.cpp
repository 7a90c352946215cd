/// Each call that SQLite makes on a file fails or is the process's last: afterwards all acknowledged data are
/// there, nothing is doubled or changed, and the command can be finished.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <functional>

#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/read/status.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/fault_flows.hpp"
#include "tests/libstudy/fault_vfs.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using faults::Lines;
using test::all_flows, test::Flow;
using Kind = test::VfsFault::Kind;

Lines said_in(const fs::path& folder) {
  Lines all;
  if (!fs::exists(folder / "said")) return all;
  const std::string text = test::bytes_of(folder / "said");
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    all.push_back(text.substr(at, end - at));
  return all;
}

enum class How { WentOn, Refused, Stopped };

/// Repeats a flow from the same start.
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

  /// Runs the flow with a fault. Returns the problem; empty: none.
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

  /// The user's next steps: look at the database, and repeat the command.
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

/// Tries every `step`-th call from `first` with one kind of fault, and prints how the tries ended.
void try_calls(const Flow& flow, const Named& fault, long first, long step) {
  Trials trials(flow);
  long ended[3] = {}, failed = 0, tried = 0;
  for (long k = first; k <= trials.calls(); k += step, ++tried) {
    How how = How::WentOn;
    const std::string problem = trials.attempt({fault.kind, k}, how);
    if (problem.empty()) {
      ++ended[static_cast<int>(how)];
    } else if (++failed <= 3) {
      ADD_FAILURE() << flow.name << ", " << fault.name << " at call " << k << ": " << problem;
    }
  }
  std::printf("%-22s %-20s %6ld tries %6ld went on %6ld refused %6ld stopped %6ld failed\n", flow.name,
              fault.name, tried, ended[0], ended[1], ended[2], failed);
  EXPECT_EQ(failed, 0) << flow.name << ", " << fault.name;
}

/// Tries a few calls over the whole length of the flow, different ones for each kind of fault; FaultsSlow
/// tries all.
void try_some(const char* name) {
  constexpr long tries = 3;
  for (const Flow& flow : all_flows())
    if (flow.name == std::string(name)) {
      const long step = std::max(1L, Trials(flow).calls() / tries);
      for (std::size_t i = 0; i < std::size(kinds); ++i)
        try_calls(flow, kinds[i], 1 + static_cast<long>(i) * step / std::ssize(kinds), step);
    }
}

TEST(Faults, SomeCallsOfSessions) { try_some("session"); }
TEST(Faults, SomeCallsOfResumes) { try_some("resume"); }
TEST(Faults, SomeCallsOfExports) { try_some("export"); }
TEST(Faults, SomeCallsOfSalvages) { try_some("salvage"); }
TEST(Faults, SomeCallsOfWithdrawals) { try_some("withdrawal"); }
TEST(Faults, SomeCallsOfConsents) { try_some("consent"); }
TEST(Faults, SomeCallsOfMerges) { try_some("merge"); }
TEST(Faults, SomeCallsOfUpgradesFromSchema1) { try_some("upgrade from schema 1"); }
TEST(Faults, SomeCallsOfUpgradesFromSchema2) { try_some("upgrade from schema 2"); }
TEST(Faults, SomeCallsOfUpgradesFromSchema3) { try_some("upgrade from schema 3"); }
TEST(Faults, SomeCallsOfUpgradesFromSchema4) { try_some("upgrade from schema 4"); }
TEST(Faults, SomeCallsOfUpgradesFromSchema5) { try_some("upgrade from schema 5"); }

/// Tries every call: one test for each flow and kind of fault, so that they run in parallel.
class FaultsSlow : public testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};

TEST_P(FaultsSlow, EveryCall) {
  const auto [flow, kind] = GetParam();
  try_calls(all_flows().at(flow), kinds[kind], 1, 1);
}

std::string test_name(const testing::TestParamInfo<FaultsSlow::ParamType>& info) {
  const auto [flow, kind] = info.param;
  std::string name = all_flows().at(flow).name + std::string(" ") + kinds[kind].name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(, FaultsSlow,
                         testing::Combine(testing::Range(std::size_t{0}, all_flows().size()),
                                          testing::Range(std::size_t{0}, std::size(kinds))),
                         test_name);

/// If the disk fills in the first commit of a new database, only the journal has the plan. The next run takes
/// it over and is then refused because the plan exists: the plan must not be deleted with that run's new
/// file.
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

/// Test of the model itself: a power cut loses unsynced data and keeps synced data.
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
