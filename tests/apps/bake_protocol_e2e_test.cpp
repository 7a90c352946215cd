/// vip-study bake --protocol as a user runs it, on a small scene that settles in one frame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "libsim/bake/bake_file.hpp"
#include "stats/ptpe/ptpe.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class BakeProtocolE2e : public ::testing::Test {
 protected:
  BakeProtocolE2e() {
    const std::string scene = base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20);
    base::write_file_atomically(scene_, replaced(scene, "settle_frames = 120", "settle_frames = 1"));
    write_protocol(true, "\"LoRes\", \"Ours-TSp\"");
  }
  /// Two settings for each method, and trials of 0.4 s.
  void write_protocol(bool fixation, const std::string& methods, const std::string& n_star = "64") {
    const std::string text = with_keys(short_protocol("0.4"), {{"scene", "[\"" + scene_ + "\"]"},
                                                               {"sd_fps", "[5]"},
                                                               {"method", "[" + methods + "]"},
                                                               {"n_star", "[\"" + n_star + "\"]"}});
    base::write_file_atomically(
        protocol_, with_before(text, "participants = ", fixation ? "gaze = \"fixation\"\n" : ""));
  }
  std::vector<std::string> command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> out{vip_study, "bake",   "--protocol", protocol_,   "--out",
                                 out_,      "--size", size_,        "--backend", "cpu"};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  Ended bake(const std::vector<std::string>& more = {}) const { return run_program(command(more)); }
  /// The inode of each bake by file name. It changes if the bake is made again.
  std::map<std::string, ino_t> bakes() const {
    std::map<std::string, ino_t> out;
    for (const auto& entry : fs::directory_iterator(out_)) {
      struct stat status {};
      ::stat(entry.path().c_str(), &status);
      out[entry.path().filename()] = status.st_ino;
    }
    return out;
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "dam.toml", protocol_ = folder_ / "short.toml", out_ = folder_ / "bakes";
  std::string size_ = "64x36";
  const std::string coarse_ = "dam_64_LoRes.bake", slow_ = "dam_64_Ours-TSp_20_5.bake",
                    fast_ = "dam_64_Ours-TSp_50_5.bake";
};

TEST_F(BakeProtocolE2e, WhatFollowsAFreeGazeIsSaidToRunLive) {
  write_protocol(false, "\"LoRes\", \"FovFluid\", \"Ours-TSp\"");
  const Ended ended = bake();
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("3 stimuli run live: it follows the gaze"),
                               HasSubstr("1 bakes to make take up to"), HasSubstr("GB are free"),
                               HasSubstr("all 1 bakes of short are whole")));
  EXPECT_EQ(bakes().size(), 1u);
  EXPECT_EQ(sim::BakeReader(fs::path(out_) / coarse_).header().frame_count, 20) << "of 50 frames/s";
}

TEST_F(BakeProtocolE2e, WithNothingToBakeItSaysWhy) {
  write_protocol(false, "\"Ours\"");
  const Ended ended = bake();
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("no stimulus that can be baked: it follows the gaze"), HasSubstr("mend: ")));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(BakeProtocolE2e, UnderFixationTheHeaderHoldsGazeAnglesAndTau) {
  const Ended ended = bake({"--screen-width-mm", "520", "--viewing-distance-mm", "600"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  ASSERT_EQ(bakes().size(), 3u);
  const sim::BakeReader bake(fs::path(out_) / slow_);
  const sim::BakeHeader& header = bake.header();
  const sim::BakedView& view = header.view;
  EXPECT_EQ(view.gaze, "middle");
  ASSERT_EQ(view.gaze_path.size(), 1u);
  EXPECT_EQ(view.gaze_path[0].point_m, sim::read_scene(scene_).view.target_m);
  EXPECT_EQ(view.width_px, 64);
  EXPECT_EQ(view.camera_angle_deg, 75);
  EXPECT_NEAR(view.visual_angle_deg.value_or(0), 2 * std::atan(520.0 * 36 / 64 / 2 / 600) * 180 / M_PI, 1e-9);
  EXPECT_THAT(view.renderer, HasSubstr("OpenGL 4.5"));
  ASSERT_TRUE(header.tolerance);
  EXPECT_EQ(header.tolerance->rate.mean, 20);
  EXPECT_EQ(sim::BakeReader(fs::path(out_) / coarse_).header().view.gaze, "none");
}

TEST_F(BakeProtocolE2e, OursTspIsBakedByTheProtocolsTolerance) {
  ASSERT_EQ(bake().exit_code, 0);
  const double tau = stats::ptpe_tolerance({}, 20, 5);
  ASSERT_LT(tau, 0);
  const sim::BakeReader slow(fs::path(out_) / slow_), fast(fs::path(out_) / fast_);
  sim::BakeFrame frame;
  bool left_out = false;
  for (std::int64_t i = 1; i < slow.header().frame_count; ++i) {
    slow.read_frame(i, frame);
    ASSERT_TRUE(frame.facts.account.temporal && frame.facts.account.temporal->tau);
    EXPECT_NEAR(*frame.facts.account.temporal->tau, tau, 1e-9);
    left_out = left_out || frame.facts.account.temporal->active < frame.facts.account.particles();
  }
  EXPECT_TRUE(left_out);
  fast.read_frame(5, frame);
  EXPECT_GT(*frame.facts.account.temporal->tau, 0);
}

TEST_F(BakeProtocolE2e, ARerunKeepsWhatIsGoodAndMakesTheRestAgain) {
  ASSERT_EQ(bake().exit_code, 0);
  const auto before = bakes();
  const Ended kept = bake();
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_EQ(bakes(), before);
  EXPECT_THAT(kept.out, AllOf(HasSubstr(coarse_ + ": whole, kept"), Not(HasSubstr("made again"))));

  const fs::path damaged = fs::path(out_) / coarse_;
  std::string bytes = base::read_file(damaged, 1u << 30);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  base::write_file_atomically(damaged, bytes);
  fs::resize_file(fs::path(out_) / fast_, 100);
  const Ended mended = bake();
  ASSERT_EQ(mended.exit_code, 0) << mended.err;
  EXPECT_THAT(mended.out, AllOf(HasSubstr("does not match its checksum; is made again"),
                                HasSubstr("is truncated"), HasSubstr(slow_ + ": whole, kept")));
  const auto after = bakes();
  EXPECT_EQ(after.at(slow_), before.at(slow_));
  EXPECT_EQ(run_program({vip_study, "bake", "--verify", damaged}).exit_code, 0);
}

TEST_F(BakeProtocolE2e, AnotherPictureIsAnotherBakeOfWhatFollowsIt) {
  ASSERT_EQ(bake().exit_code, 0);
  size_ = "80x45";
  const Ended larger = bake();
  ASSERT_EQ(larger.exit_code, 0) << larger.err;
  EXPECT_THAT(larger.out, AllOf(HasSubstr("picture 64x36 instead of 80x45; is made again"),
                                HasSubstr(coarse_ + ": whole, kept")));
  const Ended pictures = bake({"--keep", "pictures"});
  ASSERT_EQ(pictures.exit_code, 0) << pictures.err;
  EXPECT_THAT(pictures.out, HasSubstr(coarse_ + ": particles alone instead of pictures; is made again"));
  EXPECT_TRUE(sim::BakeReader(fs::path(out_) / coarse_).header().has_pictures());
}

TEST_F(BakeProtocolE2e, AKilledOneLeavesWholeBakesAndTheNextGoesOn) {
  write_protocol(false, "\"LoRes\", \"HiRes\"", "2k");
  Process process(command());
  // Waits until the second bake is being made.
  while (const auto line = process.read_line()) {
    if (line->find("1 of 2 made") != std::string::npos) break;
  }
  while (bakes().size() < 2) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  process.send(SIGKILL);
  EXPECT_EQ(process.wait().signal, SIGKILL);
  const fs::path first = fs::path(out_) / "dam_2k_LoRes.bake", second = fs::path(out_) / "dam_2k_HiRes.bake";
  EXPECT_NO_THROW(sim::BakeReader{first});
  EXPECT_FALSE(fs::exists(second));
  const Ended ended = bake();
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("dam_2k_LoRes.bake: whole, kept"), HasSubstr("1 bakes to make")));
  EXPECT_NO_THROW(sim::BakeReader{second});
  EXPECT_EQ(bakes().size(), 2u) << "the killed one's draft";
}

TEST_F(BakeProtocolE2e, AFullDiskIsOneErrorAndKeepsWhatIsWhole) {
  write_protocol(false, "\"LoRes\", \"HiRes\"", "2k");
  const auto limited = [] {
    const rlimit limit{600'000, 600'000};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
  const Ended ended = run_program(command(), limited);
  EXPECT_EQ(ended.exit_code, 1) << ended.signal;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("dam_2k_HiRes.bake: cannot be written"), HasSubstr("free space")));
  EXPECT_EQ(bakes().size(), 1u) << "LoRes is whole";
}

TEST_F(BakeProtocolE2e, TooLittleRoomIsToldBeforeAnyWork) {
  write_protocol(false, "\"HiRes\"", "4096k");
  replace_in(protocol_, "duration_s = 0.4", "duration_s = 3600");
  const Ended ended = bake();
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("1 bakes take up to"), HasSubstr("GB are free"), HasSubstr("mend: ")));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(BakeProtocolE2e, WhatItIsSaidToTakeIsEnough) {
  write_protocol(true, "\"LoRes\", \"HiRes\", \"Ours\"");
  const Ended ended = bake({"--keep", "pictures"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  for (const auto& [name, inode] : bakes()) {
    const sim::BakeReader bake(fs::path(out_) / name);
    const auto& h = bake.header();
    const auto particles = sim::particle_count(sim::parse_method(h.method), h.n_star);
    // 10,000 bytes are allowed for the header and index, which in such a short file are as large as the
    // frames.
    EXPECT_LT(bake.file_bytes(),
              static_cast<std::uint64_t>(h.frame_count * (6 * particles + 64 * 36)) + 10'000)
        << name;
  }
}

}  // namespace
}  // namespace apps::test
