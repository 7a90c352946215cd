/// vip-bench accuracy: timed cells run one after the other on a machine, whichever programs started them.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <sstream>

#include "libstudy/sweep/run/machine_lock.hpp"
#include "libstudy/sweep/sweep_file.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class MachineLockTest : public ::testing::Test {
 protected:
  MachineLockTest() { ::setenv("VIP_LOCK_DIR", folder_.path().c_str(), 1); }
  ~MachineLockTest() override { ::unsetenv("VIP_LOCK_DIR"); }

  const ::test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "vip-bench.lock";
};

/// Locks the file through a descriptor of its own, as another program would.
class Other {
 public:
  explicit Other(const std::filesystem::path& file) : fd_(::open(file.c_str(), O_RDONLY | O_CREAT, 0644)) {}
  ~Other() { ::close(fd_); }
  bool lock() { return ::flock(fd_, LOCK_EX | LOCK_NB) == 0; }
  void unlock() { ::flock(fd_, LOCK_UN); }

 private:
  int fd_;
};

TEST_F(MachineLockTest, IsHeldAsLongAsItLives) {
  Other other(file_);
  {
    const study::MachineLock lock;
    EXPECT_FALSE(other.lock());
  }
  EXPECT_TRUE(other.lock());
}

TEST_F(MachineLockTest, EveryUserCanOpenItsFile) {
  const ::mode_t before = ::umask(0077);
  { const study::MachineLock lock; }
  ::umask(before);
  struct stat found {};
  ASSERT_EQ(::stat(file_.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0644u);
}

TEST_F(MachineLockTest, WhatIsNoLockFileIsNamedWithItsMend) {
  std::filesystem::create_symlink(folder_ / "elsewhere", file_);
  EXPECT_THAT([] { study::MachineLock(); },
              ThrowsMessage<base::Error>(AllOf(HasSubstr(file_.string()), HasSubstr("VIP_LOCK_DIR"))));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "elsewhere"));
  ::setenv("VIP_LOCK_DIR", (folder_ / "none").c_str(), 1);
  EXPECT_THAT([] { study::MachineLock(); }, ThrowsMessage<base::Error>(HasSubstr("none/vip-bench.lock")));
}

class MachineLockE2e : public MachineLockTest {
 protected:
  /// Runs vip-bench accuracy. Its stdout has the lines of stderr too.
  test::Process bench(const std::string& arguments) const {
    return test::Process({"/bin/sh", "-c",
                          "exec env -u DISPLAY VIP_CACHE_DIR= " VIP_BIN_DIR "/vip-bench accuracy " +
                              arguments + " --backend cpu 2>&1"});
  }
  std::string first_key(const std::string& options) const {
    auto process = bench(options + " --list");
    const auto line = process.read_line();
    return line ? line->substr(0, line->find(' ')) : "";
  }
  const std::string shard_ = folder_ / "shard.db";
};

TEST_F(MachineLockE2e, ACellWaitsUntilTheLockIsFree) {
  const std::string quick = "--quick --n-star 64 --seconds 0.1 --seeds 1";
  Other other(file_);
  ASSERT_TRUE(other.lock());
  auto cell = bench(quick + " --cell " + first_key(quick) + " --out " + shard_);
  EXPECT_THAT(cell.read_line().value_or(""), AllOf(HasSubstr("waits"), HasSubstr(file_.string())));
  const auto cells_there = [&] { return study::SweepFile(shard_, study::sqlite::Open::Read).cells().size(); };
  EXPECT_EQ(cells_there(), 0u);
  other.unlock();
  const auto ended = cell.wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_EQ(cells_there(), 1u);
}

TEST_F(MachineLockE2e, AKilledHolderFreesIt) {
  const std::string minutes = "--n-star 4k --seconds 60";
  auto holder = bench(minutes + " --cell " + first_key(minutes) + " --out " + shard_);
  Other other(file_);
  while (other.lock()) {
    other.unlock();
    ::usleep(10'000);
  }
  holder.send(SIGKILL);
  EXPECT_EQ(holder.wait().signal, SIGKILL);
  EXPECT_TRUE(other.lock());
}

}  // namespace
}  // namespace apps
