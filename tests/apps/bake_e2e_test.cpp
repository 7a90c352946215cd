/// vip-study bake as a user runs it, on a small scene that settles in few frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include "libsim/bake/bake_file.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/libsim/bake/make_bake.hpp"

namespace {

using apps::test::Ended;
using apps::test::Process;
using ::testing::AllOf;
using ::testing::HasSubstr;

class BakeE2e : public ::testing::Test {
 protected:
  BakeE2e() {
    std::string text = base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20);
    const std::string key = "settle_frames = 120";
    text.replace(text.find(key), key.size(), "settle_frames = 2");
    std::ofstream(scene_) << text;
  }
  std::vector<std::string> command(std::vector<std::string> more, const std::string& n_star = "64") const {
    std::vector<std::string> out{std::string(VIP_BIN_DIR) + "/vip-study",
                                 "bake",
                                 scene_.string(),
                                 "--n-star",
                                 n_star,
                                 "--backend",
                                 "cpu",
                                 "--out",
                                 target_.string()};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(folder_.path()), {});
  }
  /// True if the scene file is the only one in the folder.
  bool left_nothing() const { return files() == 1; }

  bake_test::Folder folder_;
  std::filesystem::path scene_ = folder_ / "dam.toml";
  std::filesystem::path target_ = folder_ / "dam.bake";
};

TEST_F(BakeE2e, BakesBothMethodsAndVerifies) {
  for (const std::string method : {"HiRes", "LoRes"}) {
    const Ended baked = apps::test::run_program(command({"--frames", "5", "--method", method, "--force"}));
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
    const std::string count = method == "HiRes" ? "512" : "64";
    EXPECT_THAT(baked.out, HasSubstr("5 frames of " + count + " particles"));
    const Ended checked = apps::test::run_program(
        {std::string(VIP_BIN_DIR) + "/vip-study", "bake", "--verify", target_.string()});
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
    EXPECT_THAT(checked.out, HasSubstr("all 5 frames are whole"));
    sim::BakeFrame frame;
    const sim::BakeReader bake(target_);
    bake.read_frame(4, frame);
    EXPECT_EQ(frame.particles.size(), static_cast<std::size_t>(std::stoi(count)));
    EXPECT_NEAR(frame.facts.time_s, 4.0 / 60, 1e-12);
  }
}

TEST_F(BakeE2e, ParticlesThatSplitAndMergeKeepTheirLevels) {
  for (const std::string pictures : {"", "64x36"}) {
    std::vector<std::string> more{"--frames", "12", "--method", "Ours", "--force"};
    if (!pictures.empty()) more.insert(more.end(), {"--pictures", pictures});
    const Ended baked = apps::test::run_program(command(more));
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
    EXPECT_THAT(baked.out, HasSubstr("12 frames of up to 512 particles"));
    const sim::BakeReader bake(target_);
    const auto& radii = bake.header().radius_by_level_m;
    ASSERT_EQ(radii.size(), 4u);
    for (std::size_t k = 1; k < 4; ++k) EXPECT_NEAR(std::pow(radii[k] / radii[k - 1], 3), 2, 1e-5);
    bool merged = false;
    for (int i = 0; i < 12; ++i) {
      sim::BakeFrame frame;
      bake.read_frame(i, frame);
      ASSERT_EQ(frame.facts.account.particles_by_level.size(), 4u);
      std::int64_t mass = 0, counted = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        mass += frame.facts.account.particles_by_level[k] << k;
        counted += frame.facts.account.particles_by_level[k];
      }
      EXPECT_EQ(mass, 512) << "frame " << i << ": no level may be taken for another";
      EXPECT_EQ(frame.particles.size(), static_cast<std::size_t>(counted));
      merged = merged || counted < 512;
    }
    EXPECT_TRUE(merged) << "otherwise the first frame's radii would do";
  }
}

TEST_F(BakeE2e, EqualCommandsGiveEqualFilesWithPictures) {
  ASSERT_EQ(apps::test::run_program(command({"--frames", "3", "--pictures", "64x36"})).exit_code, 0);
  const sim::Bytes first = bake_test::read_all(target_);
  ASSERT_EQ(apps::test::run_program(command({"--frames", "3", "--pictures", "64x36", "--force"})).exit_code,
            0);
  EXPECT_EQ(bake_test::read_all(target_), first);
  EXPECT_EQ(sim::BakeReader(target_).header().camera, "view");
}

TEST_F(BakeE2e, WrongInputIsOneErrorAndLeavesNothing) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--pictures", "640"}, "is not a size"},
      {{"--pictures", "640x360x3"}, "is not a size"},
      {{"--pictures", "9000x360"}, "is not a size"},
      {{"--method", "MidRes"}, "use one of \"LoRes\", \"HiRes\", \"FovFluid\", \"Ours\", \"Ours-TSp\""}};
  for (const auto& [more, message] : cases) {
    const Ended ended = apps::test::run_program(command(more));
    EXPECT_EQ(ended.exit_code, 1);
    EXPECT_THAT(ended.err, AllOf(HasSubstr(message), HasSubstr("mend:")));
  }
  EXPECT_EQ(apps::test::run_program(command({"--frames", "0"})).exit_code, 2);
  EXPECT_TRUE(left_nothing());
}

TEST_F(BakeE2e, ExistingFileStays) {
  std::ofstream(target_) << "precious";
  const Ended ended = apps::test::run_program(command({"--frames", "2"}));
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("exists already"), HasSubstr("--force")));
  EXPECT_EQ(base::read_file(target_, 100), "precious");
}

TEST_F(BakeE2e, FullDiskLeavesNothing) {
  const auto limited = [] {
    const rlimit limit{20'000, 20'000};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
  const Ended ended = apps::test::run_program(command({"--frames", "60"}), limited);
  EXPECT_EQ(ended.exit_code, 1) << ended.signal;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("dam.bake: cannot be written"), HasSubstr("free space")));
  EXPECT_TRUE(left_nothing());
}

TEST_F(BakeE2e, FolderThatMayNotBeWrittenToIsNamedBeforeAnyWork) {
  const auto unprivileged = [] {
    if (getuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) _exit(125);
  };
  std::filesystem::permissions(folder_.path(), std::filesystem::perms(0555));
  const Ended ended = apps::test::run_program(command({"--frames", "2"}, "4096k"), unprivileged);
  std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
  if (ended.exit_code == 126) GTEST_SKIP() << "the program lies where another user may not run it";
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("dam.bake: cannot be created"), HasSubstr("mend:")));
  EXPECT_TRUE(left_nothing());
}

TEST_F(BakeE2e, InterruptLeavesNothing) {
  Process process(command({"--frames", "100000"}));
  // Once the temporary file exists, frames are being written.
  while (left_nothing()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  process.send(SIGINT);
  const Ended ended = process.wait();
  EXPECT_EQ(ended.exit_code, 1) << ended.signal;
  EXPECT_THAT(ended.err, HasSubstr("stopped on request; no file was written"));
  EXPECT_TRUE(left_nothing());
}

/// The program opens closed standard streams on /dev/null. Otherwise the bake's file could get the number of
/// stderr, and the progress bar would be written into the bake.
TEST_F(BakeE2e, ClosedStandardStreamsAreNotTheBakes) {
  Process process(command({"--frames", "100000"}), [] {
    for (const int fd : {STDIN_FILENO, STDERR_FILENO}) ::close(fd);
  });
  while (left_nothing()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  for (const int fd : {STDIN_FILENO, STDERR_FILENO}) {
    const auto link = "/proc/" + std::to_string(process.pid()) + "/fd/" + std::to_string(fd);
    EXPECT_EQ(std::filesystem::read_symlink(link), "/dev/null");
  }
}

TEST_F(BakeE2e, AKilledBakeIsNoBakeAndTheSameCommandMakesOne) {
  Process process(command({"--frames", "100000"}));
  while (left_nothing()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  process.send(SIGKILL);
  EXPECT_EQ(process.wait().signal, SIGKILL);
  EXPECT_FALSE(std::filesystem::exists(target_));
  EXPECT_EQ(apps::test::run_program(command({"--frames", "3"})).exit_code, 0);
  EXPECT_EQ(sim::BakeReader(target_).header().frame_count, 3);
  EXPECT_EQ(files(), 2) << "the killed one's draft";
}

TEST_F(BakeE2e, TruncatedFileIsRefusedByName) {
  ASSERT_EQ(apps::test::run_program(command({"--frames", "3"})).exit_code, 0);
  std::filesystem::resize_file(target_, std::filesystem::file_size(target_) - 1);
  const Ended ended = apps::test::run_program(
      {std::string(VIP_BIN_DIR) + "/vip-study", "bake", "--verify", target_.string()});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("dam.bake"), HasSubstr("truncated")));
}

}  // namespace
