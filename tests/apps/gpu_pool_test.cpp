/// One GPU for each job: scripts/with_gpu.sh, and scripts/sweep.smk with --backend cuda. A stub takes the
/// place of vip-bench and writes down which GPU it was given and when.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The time of a run on a GPU, s; `end` is infinite if it was killed.
struct GpuRun {
  std::string gpu, key;
  double begin = 0, end = HUGE_VAL;
};

/// Writes "begin|end PROCESS GPU KEY SECONDS"; a cell writes its key as its shard.
constexpr const char* stub = R"stub(#!/bin/bash
note() { echo "$1 $$ ${CUDA_VISIBLE_DEVICES:-none} $key $EPOCHREALTIME" >>"$NOTES"; }
words=" $* "
case "$words" in
  *" --list "*) for i in ${CELLS:-1 2 3 4}; do echo "cell$i words of it"; done; exit ;;
  *" --cell "*) ;;
  *) for ((i = 1; i <= $#; ++i)); do
       case "${!i}" in --db|--csv|--prices-csv|--markdown|--html) i=$((i + 1)); : >"${!i}" ;; esac
     done; exit ;;
esac
key=${words#* --cell }; key=${key%% *}
out=${words#* --out }; out=${out%% *}
[ ! -e "$out" ] || exit 0
note begin; sleep "${LASTS:-0.4}"; mkdir -p "$(dirname "$out")";
echo "$key" > "$out"; note end
)stub";

class GpuPool : public ::testing::Test {
 protected:
  GpuPool() {
    fs::create_directories(folder_ / "bin");
    std::ofstream(folder_ / "bin/vip-bench") << stub;
    fs::permissions(folder_ / "bin/vip-bench", fs::perms::owner_all);
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string environment() const {
    return "env -u CUDA_VISIBLE_DEVICES -u SLURM_JOB_ID NOTES=" + at("notes") +
           " VIP_LOCK_DIR=" + folder_.path().string() + " XDG_CACHE_HOME=" + at("cache") + " ";
  }
  /// Runs a command line in a session of its own, from this test's folder.
  test::Process start(const std::string& line) const {
    return test::Process(
        {"/bin/bash", "-c", "cd " + folder_.path().string() + " && exec " + environment() + line},
        [] { ::setsid(); });
  }
  test::Process with_gpu(const std::string& gpus, const std::string& cell,
                         const std::string& more = "") const {
    return start(more + script_ + " " + gpus + " bin/vip-bench --cell " + cell + " --out " + cell + " 2>&1");
  }
  std::vector<GpuRun> runs() const {
    std::map<std::string, GpuRun> out;
    std::ifstream notes(at("notes"));
    GpuRun run;
    std::string what, process;
    for (double time = 0; notes >> what >> process >> run.gpu >> run.key >> time;) {
      GpuRun& one = out.try_emplace(process, run).first->second;
      (what == "begin" ? one.begin : one.end) = time;
    }
    std::vector<GpuRun> list;
    for (const auto& [number, one] : out) list.push_back(one);
    return list;
  }
  /// Waits until `count` runs have begun.
  void wait_for(std::size_t count) const {
    while (runs().size() < count) ::usleep(5000);
  }
  /// Largest number of runs at once, of one GPU or of all.
  static int most_at_once(const std::vector<GpuRun>& runs, const std::string& gpu = "") {
    int most = 0;
    for (const GpuRun& at : runs)
      if (gpu.empty() || at.gpu == gpu)
        most =
            std::max(most, static_cast<int>(std::ranges::count_if(runs, [&](const GpuRun& one) {
                       return (gpu.empty() || one.gpu == gpu) && one.begin <= at.begin && at.begin < one.end;
                     })));
    return most;
  }
  static void expect_one_each(const std::vector<GpuRun>& runs, const std::vector<std::string>& gpus) {
    std::set<std::string> used;
    for (const GpuRun& run : runs) used.insert(run.gpu);
    EXPECT_EQ(used, std::set<std::string>(gpus.begin(), gpus.end()));
    for (const auto& gpu : gpus) EXPECT_EQ(most_at_once(runs, gpu), 1) << "GPU " << gpu;
    EXPECT_EQ(most_at_once(runs), static_cast<int>(gpus.size()));
  }

  const std::string root_ = fs::path(VIP_TEST_DIR).parent_path();
  const std::string script_ = root_ + "/scripts/with_gpu.sh";
  const ::test::TemporaryFolder folder_;
};

using WithGpuE2e = GpuPool;

TEST_F(WithGpuE2e, GivesEachCommandAGpuThatNoOtherHas) {
  std::vector<std::unique_ptr<test::Process>> all;
  for (const char* cell : {"a", "b", "c", "d", "e"})
    all.push_back(std::make_unique<test::Process>(
        std::vector<std::string>{"/bin/bash", "-c",
                                 "cd " + folder_.path().string() + " && exec " + environment() + script_ +
                                     " 3,GPU-5f bin/vip-bench --cell " + cell + " --out " + cell + " 2>&1"}));
  for (const auto& one : all) EXPECT_EQ(one->wait().exit_code, 0);
  EXPECT_EQ(runs().size(), 5u);
  expect_one_each(runs(), {"3", "GPU-5f"});
}

TEST_F(WithGpuE2e, AKilledCommandFreesItsGpu) {
  auto first = with_gpu("0", "a", "LASTS=60 ");
  wait_for(1);
  auto second = with_gpu("0", "b");
  EXPECT_THAT(second.read_line().value_or(""), HasSubstr("waits for a free GPU of 0"));
  EXPECT_EQ(runs().size(), 1u);
  ::kill(-first.pid(), SIGKILL);
  first.wait();
  EXPECT_EQ(second.wait().exit_code, 0);
  EXPECT_EQ(runs().size(), 2u);
}

TEST_F(WithGpuE2e, TimedRunsOfTheCpuAndOfAGpuWaitForEachOther) {
  const int fd = ::open(at("vip-bench.lock").c_str(), O_RDONLY | O_CREAT, 0644);
  ASSERT_EQ(::flock(fd, LOCK_EX), 0);
  auto cell = with_gpu("0", "a", "LASTS=60 ");
  EXPECT_THAT(cell.read_line().value_or(""),
              AllOf(HasSubstr("waits for a timed run on this machine"), HasSubstr(at("vip-bench.lock"))));
  EXPECT_TRUE(runs().empty());
  ::flock(fd, LOCK_UN);
  wait_for(1);
  EXPECT_NE(::flock(fd, LOCK_EX | LOCK_NB), 0) << "the run holds its share";
  ::kill(-cell.pid(), SIGKILL);
  cell.wait();
  EXPECT_EQ(::flock(fd, LOCK_EX), 0);
  ::close(fd);
}

TEST_F(WithGpuE2e, InAJobOfSlurmTheGpuIsSlurms) {
  const std::string job = "SLURM_JOB_ID=7 CUDA_VISIBLE_DEVICES=0 SLURM_JOB_GPUS=";
  auto one = with_gpu("0,1", "a", job + "2 "), other = with_gpu("0,1", "b", job + "3 ");
  EXPECT_EQ(one.wait().exit_code, 0);
  EXPECT_EQ(other.wait().exit_code, 0);
  EXPECT_EQ(most_at_once(runs()), 2) << "two GPUs of the node";
  for (const GpuRun& run : runs()) EXPECT_EQ(run.gpu, "0") << "as Slurm numbers it";
  EXPECT_TRUE(fs::is_directory(folder_ / "vip-gpu-2"));
}

TEST_F(WithGpuE2e, RefusesWithRemedies) {
  const auto refused = [&](const std::string& line, const std::string& what) {
    const auto ended = start(line + " 2>&1").wait();
    EXPECT_EQ(ended.exit_code, 1) << line;
    EXPECT_THAT(ended.out, AllOf(HasSubstr(what), HasSubstr("mend: "))) << line;
  };
  refused(script_ + " 0", "no GPU and command are given");
  refused(script_ + " '0;1' true", "'0;1' is no list of GPUs");
  refused(script_ + " '' true", "is no list of GPUs");
  refused("VIP_LOCK_DIR=" + at("none") + " " + script_ + " 0 true", at("none") + ": no folder for locks");
  EXPECT_EQ(start(script_ + " 0 bash -c 'exit 7'").wait().exit_code, 7);
}

class GpuSweepE2e : public GpuPool {
 protected:
  void SetUp() override {
    ASSERT_EQ(test::run_shell("command -v snakemake").exit_code, 0)
        << "scripts/setup.sh sweeps installs Snakemake";
  }
  /// The workflow on two GPUs and six cores.
  test::Process workflow(const std::string& options = "") const {
    return start("snakemake -s " + root_ + "/scripts/sweep.smk --cores 6 " + options +
                 " --config accuracy='--quick --backend cuda' gpus=2 bin=bin out=out >>log 2>&1");
  }
  std::string log() const { return base::read_file(at("log"), 1 << 22); }
  void expect_whole(std::size_t cells) const {
    expect_one_each(runs(), {"0", "1"});
    std::set<std::string> keys;
    for (const GpuRun& run : runs()) keys.insert(run.key);
    EXPECT_EQ(keys.size(), cells);
    EXPECT_TRUE(fs::exists(at("out/accuracy/accuracy.html")));
  }
};

TEST_F(GpuSweepE2e, RunsOneJobOnEachGpu) {
  ASSERT_EQ(workflow().wait().exit_code, 0) << log();
  expect_whole(4);
  EXPECT_THAT(log(), AllOf(HasSubstr("gpu=1"), HasSubstr("threads: 3")));
}

TEST_F(GpuSweepE2e, RunsOneJobOnEachGpuAlsoAfterSnakemakeWasKilled) {
  ::setenv("CELLS", "1 2 3 4 5 6 7 8", 1);
  auto killed = workflow();
  wait_for(3);
  ::kill(killed.pid(), SIGKILL);  // Snakemake alone: its cells go on
  EXPECT_EQ(killed.wait().signal, SIGKILL);
  ASSERT_EQ(workflow("--unlock").wait().exit_code, 0) << log();
  ASSERT_EQ(workflow("--rerun-incomplete").wait().exit_code, 0) << log();
  expect_whole(8);
  ::unsetenv("CELLS");
  const auto refused = start("snakemake -s " + root_ +
                             "/scripts/sweep.smk --cores 1 -n --config bin=bin accuracy=--quick gpus=2 2>&1")
                           .wait();
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.out, HasSubstr("gpus= is for accuracy with --backend cuda"));
}

}  // namespace
}  // namespace apps
