/// scripts/sweep.smk: a workflow that is killed half-way and continued gives the serial run's result.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <chrono>
#include <fstream>
#include <sstream>

#include "tests/apps/pilot_database.hpp"
#include "tests/apps/rival_study.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;

/// A running program that computes a cell.
struct Worker {
  pid_t pid = 0;
  fs::path shard;
};

class SweepWorkflowE2e : public test::TableTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(test::run_shell("command -v snakemake").exit_code, 0)
        << "scripts/setup.sh sweeps installs Snakemake";
  }

  /// Runs the workflow in its own session, from this test's folder, on two cores.
  test::Process workflow(const std::string& arguments) const {
    return test::Process(
        {"/bin/sh", "-c",
         "cd " + folder.path().string() + " && exec " + environment() + "snakemake -s " + root_ +
             "/scripts/sweep.smk --cores 2 " + arguments + " bin=" VIP_BIN_DIR " out=out >>log 2>&1"},
        [] { ::setsid(); });
  }
  /// Environment without stored settled states, and with locks and caches in this test's folder.
  std::string environment() const {
    const std::string own = folder.path().string();
    return "env -u DISPLAY OMP_NUM_THREADS=2 VIP_CACHE_DIR= VIP_LOCK_DIR=" + own + " XDG_CACHE_HOME=" + own +
           " ";
  }
  std::string log() const { return base::read_file(path("log"), 1 << 22); }

  std::vector<Worker> workers() const {
    std::vector<Worker> out;
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const std::string name = entry.path().filename();
      if (name.find_first_not_of("0123456789") != std::string::npos) continue;
      std::error_code gone;
      if (fs::read_symlink(entry.path() / "cwd", gone) != folder.path() || gone) continue;
      std::ifstream line(entry.path() / "cmdline");
      std::vector<std::string> words;
      for (std::string word; std::getline(line, word, '\0');) words.push_back(word);
      const auto out_at = std::find(words.begin(), words.end(), "--out");
      if (words.empty() || words[0].rfind(VIP_BIN_DIR, 0) != 0 || words.end() - out_at < 2) continue;
      out.push_back({std::stoi(name), folder / out_at[1]});
    }
    return out;
  }

  /// State of a process: 'T' if it is stopped; 0 if it is gone.
  static char state_of(pid_t pid) {
    std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
    std::string text;
    std::getline(stat, text);
    const auto name_end = text.rfind(')');
    return name_end == std::string::npos ? '\0' : text[name_end + 2];
  }
  static bool stop(pid_t pid) {
    ::kill(pid, SIGSTOP);
    while (state_of(pid) != 'T') {
      if (state_of(pid) == '\0' || state_of(pid) == 'Z') return false;
      ::usleep(1000);
    }
    return true;
  }

  /// Waits for `least_done` finished jobs, then returns a worker that is stopped in the middle of its cell.
  /// Throws after five minutes.
  template <class InCell>
  Worker stop_a_worker(const std::string& kind, std::size_t least_done, InCell in_cell) const {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(5);
    while (std::chrono::steady_clock::now() < deadline) {
      if (done_shards(kind).size() >= least_done) {
        for (const Worker& worker : workers()) {
          if (!stop(worker.pid)) continue;
          if (in_cell(worker)) return worker;
          ::kill(worker.pid, SIGCONT);
        }
      }
      ::usleep(5000);
    }
    throw std::runtime_error("no worker was stopped in a cell within five minutes; see the log:\n" + log());
  }

  /// A shard and when it was written.
  struct Written {
    fs::file_time_type time;
    std::string bytes;
    bool operator==(const Written&) const = default;
  };
  static Written written(const fs::path& shard) {
    return {fs::last_write_time(shard), base::read_file(shard, 1 << 24)};
  }
  /// Shards of finished jobs; each job here is one cell.
  std::map<fs::path, Written> done_shards(const std::string& kind) const {
    std::map<fs::path, Written> out;
    const fs::path done = folder / ("out/" + kind + "/done");
    if (!fs::exists(done)) return out;
    for (const auto& entry : fs::directory_iterator(done)) {
      const std::string job = entry.path().filename();
      const fs::path shard =
          folder / ("out/" + kind + "/shards/" + job.substr(0, 16) + (kind == "accuracy" ? ".db" : ".json"));
      out[shard] = written(shard);
    }
    return out;
  }
  static void expect_kept(const std::map<fs::path, Written>& before) {
    for (const auto& [shard, then] : before) EXPECT_EQ(written(shard), then) << shard << " was run again";
  }

  /// Runs `command` of vip-stats at once and as a workflow. Of the workflow, first Snakemake and its workers
  /// are killed half-way, and then one worker. Expects equal results, but for the time of writing.
  void expect_serial_result(const std::string& command, const std::string& kind, const std::string& options,
                            std::size_t cells, const std::vector<std::string>& endings) const {
    std::string files;
    for (const auto& ending : endings) files += " --" + ending + " " + path("serial." + ending);
    const auto serial =
        test::run_shell(environment() + VIP_BIN_DIR "/vip-stats " + command + " " + options + files);
    ASSERT_EQ(serial.exit_code, 0) << serial.out;

    const std::string arguments = "--config " + kind + "='" + options + "'";
    const auto in_cell = [](const Worker& worker) { return !fs::exists(worker.shard); };
    auto whole = workflow(arguments);
    stop_a_worker(kind, 2, in_cell);
    ::kill(-whole.pid(), SIGKILL);
    EXPECT_EQ(whole.wait().signal, SIGKILL);
    for (const Worker& left : workers()) ::kill(left.pid, SIGKILL);
    const auto kept = done_shards(kind);
    EXPECT_GE(kept.size(), 2u);
    EXPECT_LT(kept.size(), cells);

    ASSERT_EQ(workflow("--unlock " + arguments).wait().exit_code, 0) << log();
    auto again = workflow("--rerun-incomplete " + arguments);
    const Worker worker = stop_a_worker(kind, kept.size() + 1, in_cell);
    ::kill(worker.pid, SIGKILL);
    ASSERT_EQ(again.wait().exit_code, 0) << log();
    EXPECT_THAT(log(), ::testing::HasSubstr("Trying to restart job"));
    expect_kept(kept);
    EXPECT_EQ(done_shards(kind).size(), cells);
    for (const auto& ending : endings)
      EXPECT_EQ(undated("out/" + kind + "/" + kind + "." + ending), undated("serial." + ending));
  }
  /// The lines of a file without the time of writing.
  std::string undated(const std::string& name) const {
    std::istringstream lines(base::read_file(path(name), 1 << 24));
    std::string out;
    for (std::string line; std::getline(lines, line);)
      if (line.find("\"date_utc\"") == std::string::npos) out += line + "\n";
    return out;
  }

  const std::string root_ = fs::path(VIP_TEST_DIR).parent_path();
};

TEST_F(SweepWorkflowE2e, AWorkerThatIsKilledHalfWayLeavesTheSerialRunsTable) {
  const std::string sweep = "--quick --n-star 64 --seconds 0.1 --seeds 1 --backend cpu";
  const auto serial = test::run_shell(environment() + VIP_BIN_DIR "/vip-bench accuracy " + sweep + " --db " +
                                      path("serial.db") + " --csv " + path("serial.csv") + " --prices-csv " +
                                      path("serial_prices.csv"));
  ASSERT_EQ(serial.exit_code, 0) << serial.out;

  const std::string arguments = "--config accuracy='" + sweep + "'";
  auto killed = workflow(arguments + " retries=0");
  // The worker that holds the machine's lock runs a cell.
  const Worker worker = stop_a_worker("accuracy", 4, [&](const Worker&) {
    const int fd = ::open(path("vip-bench.lock").c_str(), O_RDONLY);
    const bool held = ::flock(fd, LOCK_EX | LOCK_NB) != 0;
    ::close(fd);
    return held;
  });
  const auto kept = done_shards("accuracy");
  ::kill(worker.pid, SIGKILL);
  EXPECT_EQ(killed.wait().exit_code, 1) << log();
  EXPECT_GE(kept.size(), 4u);
  EXPECT_LT(kept.size(), 13u);
  EXPECT_FALSE(kept.contains(worker.shard));
  EXPECT_FALSE(fs::exists(path("out/accuracy/settings.csv")));

  // Snakemake alone is killed; a cell that runs then may end.
  auto alone = workflow(arguments);
  stop_a_worker("accuracy", kept.size() + 2, [](const Worker&) { return true; });
  ::kill(alone.pid(), SIGKILL);
  EXPECT_EQ(alone.wait().signal, SIGKILL);
  for (const Worker& left : workers()) ::kill(left.pid, SIGCONT);
  EXPECT_LT(done_shards("accuracy").size(), 13u);

  ASSERT_EQ(workflow("--unlock " + arguments).wait().exit_code, 0) << log();
  ASSERT_EQ(workflow("--rerun-incomplete " + arguments).wait().exit_code, 0) << log();
  expect_kept(kept);
  const auto rows = timeless("serial.csv");
  EXPECT_EQ(rows.size(), 11u);
  EXPECT_EQ(timeless("out/accuracy/settings.csv"), rows);
  EXPECT_EQ(timeless("out/accuracy/prices.csv"), timeless("serial_prices.csv"));
}

TEST_F(SweepWorkflowE2e, PowerGoesOnAfterTheWholeWorkflowAndAWorkerWereKilled) {
  base::write_file_atomically(path("plan.toml"),
                              "format = 1\nprotocols = []\ndirectional = false\ntests = \"mixed\"\n");
  expect_serial_result(
      "power", "power",
      "protocols/task1.toml --n 8:26:2 --studies 120 --world null --plan " + path("plan.toml"), 10,
      {"json", "csv"});
}

TEST_F(SweepWorkflowE2e, AFitGoesOnAfterTheWholeWorkflowAndAWorkerWereKilled) {
  std::vector<std::string> people;
  for (int p = 1; p <= 16; ++p) people.push_back("P" + std::to_string(p));
  testing_pilot::write_database(path("pilot.db"), testing_pilot::simulated("ptpe:a=24,b=0.02,noise=1"),
                                people);
  expect_serial_result("fit-ptpe", "fit", path("pilot.db") + " --resamples 37000", 6, {"json", "svg"});
}

TEST_F(SweepWorkflowE2e, AComparisonGoesOnAfterTheWholeWorkflowAndAWorkerWereKilled) {
  rival_study::write(path("pilot.db"), 12, [](int person, const study::TimingPredictors& timing) {
    return std::clamp(static_cast<int>(std::lround(2 * timing[6] - 1 + 0.3 * (person % 3))), 1, 7);
  });
  expect_serial_result("compare-models", "compare", path("pilot.db"), 10, {"json"});
}

}  // namespace
}  // namespace apps
