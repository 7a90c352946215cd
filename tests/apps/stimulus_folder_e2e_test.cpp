/// vip-study run --stimulus FOLDER: baked, live and missing stimuli, and refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libsim/bake/bake_file.hpp"
#include "libstudy/store/store.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class StimulusFolderE2e : public ::testing::Test {
 protected:
  StimulusFolderE2e() {
    const std::string scene = base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20);
    base::write_file_atomically(scene_, replaced(scene, "settle_frames = 120", "settle_frames = 1"));
  }
  /// One setting for each method, and trials of half a second. `more`: further keys of the protocol's head.
  void write_protocol(const std::string& methods, const std::string& more = "") {
    base::write_file_atomically(
        protocol_, with_before(with_keys(short_protocol("0.5"), {{"scene", "[\"" + scene_ + "\"]"},
                                                                 {"mean_fps", "[20]"},
                                                                 {"sd_fps", "[5]"},
                                                                 {"method", "[" + methods + "]"},
                                                                 {"n_star", "[\"64\"]"}}),
                               "participants = ", more));
  }
  Ended bake(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{vip_study, "bake",   "--protocol", protocol_,   "--out",
                                 bakes_,    "--size", "64x36",      "--backend", "cpu"};
    all.insert(all.end(), more.begin(), more.end());
    return run_program(all);
  }
  Ended run(const std::string& database, std::vector<std::string> more, const std::string& size = "64x36") {
    more.insert(more.end(),
                {"--participants", "1", "--display", "headless", "--backend", "cpu", "--size", size});
    return run_program(run_arguments(protocol_, database, more));
  }
  Ended run_baked(const std::string& size = "64x36") { return run(database_, {"--stimulus", bakes_}, size); }
  /// The query's rows, one per line.
  std::string found(const std::string& database, const std::string& sql) {
    study::sqlite::Connection connection(database, study::sqlite::Open::Read);
    study::sqlite::Statement row(connection, sql);
    std::string out;
    while (row.step()) out += row.text(0) + "\n";
    return out;
  }
  std::string found(const std::string& sql) { return found(database_, sql); }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "dam.toml", protocol_ = folder_ / "short.toml", bakes_ = folder_ / "bakes";
  std::string database_ = folder_ / "study.db";
  const std::string fixation_ = "gaze = \"fixation\"\n";
};

TEST_F(StimulusFolderE2e, MixesBakedAndLiveAndSaysWhatIsMissingAndHowToMakeIt) {
  write_protocol("\"LoRes\", \"HiRes\", \"FovFluid\"");
  ASSERT_EQ(bake().exit_code, 0);
  fs::remove(fs::path(bakes_) / "dam_64_LoRes.bake");
  const Ended ended = run_baked();
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("1 stimuli are baked: dam 64 HiRes"),
                    HasSubstr("1 run live, it follows the gaze: dam 64 FovFluid"),
                    HasSubstr("1 have no bake and run live: dam 64 LoRes; to make them: vip-study bake "
                              "--protocol " +
                              protocol_ + " --out " + bakes_ + " --size 64x36"),
                    Not(HasSubstr("test data"))));
  const std::string hash = sim::BakeReader(fs::path(bakes_) / "dam_64_HiRes.bake").content_hash();
  EXPECT_THAT(found("SELECT stimulus FROM session"),
              AllOf(HasSubstr("dam 64 LoRes live"), HasSubstr("dam 64 HiRes bake " + hash + " on cpu"),
                    HasSubstr("dam 64 FovFluid live"), HasSubstr("live on cpu")));
  EXPECT_EQ(found("SELECT cells || coalesce(copied, '') FROM framing"), "0 1 2\n") << "one way to draw all";
  EXPECT_THAT(found("SELECT renderer FROM framing"), HasSubstr("OpenGL 4.5"));
  EXPECT_EQ(found("SELECT gaze_source FROM session"), "fixed\n");
  EXPECT_EQ(count_in(database_, "SELECT count(DISTINCT presentation_id) FROM frame"), 3);
}

/// Of each frame: content step, particles by level, share of particles that were solved, and tau.
constexpr const char* frames =
    "SELECT format('%d %s %.9g %.9g', content_step, particles, active_fraction, tau_fps) FROM frame "
    "ORDER BY frame_index";

TEST_F(StimulusFolderE2e, UnderFixationABakeHoldsTheFramesOfALiveSession) {
  write_protocol("\"Ours-TSp\"", fixation_);
  const std::string live = folder_ / "live.db";
  const std::vector<std::string> seen{"--screen-width-mm", "520", "--viewing-distance-mm", "600"};
  ASSERT_EQ(run(live, seen).exit_code, 0);
  ASSERT_EQ(bake(seen).exit_code, 0);
  std::vector<std::string> more = seen;
  more.insert(more.end(), {"--stimulus", bakes_});
  const Ended ended = run(database_, more);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(count_in(database_, "SELECT count(*) FROM frame WHERE tau_fps < 0"), 9) << "all but the start";
  EXPECT_GT(count_in(database_, "SELECT count(*) FROM frame WHERE active_fraction < 1"), 0);
  EXPECT_EQ(found(frames), found(live, frames));
  EXPECT_EQ(found("SELECT gaze_source FROM session"), "fixation\n");
  EXPECT_EQ(count_in(database_, "SELECT test_data FROM session"), 0);
}

TEST_F(StimulusFolderE2e, LevelsThatFollowedAnotherPictureAreRefused) {
  write_protocol("\"FovFluid\"", fixation_);
  ASSERT_EQ(bake().exit_code, 0);
  const Ended larger = run_baked("80x45");
  EXPECT_EQ(larger.exit_code, 1);
  EXPECT_THAT(larger.err, AllOf(HasSubstr("dam_64_FovFluid.bake: holds picture 64x36 instead of 80x45"),
                                HasSubstr("mend: make it again")));
  const Ended nearer =
      run(database_, {"--stimulus", bakes_, "--screen-width-mm", "520", "--viewing-distance-mm", "600"});
  EXPECT_EQ(nearer.exit_code, 1);
  EXPECT_THAT(nearer.err, HasSubstr("angle of the eye's view not known instead of"));
  EXPECT_FALSE(fs::exists(database_));
}

TEST_F(StimulusFolderE2e, AnotherFluidIsRefused) {
  write_protocol("\"HiRes\"");
  ASSERT_EQ(bake().exit_code, 0);
  replace_in(protocol_, "duration_s = 0.5", "duration_s = 0.8");
  const Ended ended = run_baked();
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("holds 10 frames instead of 16"));
}

TEST_F(StimulusFolderE2e, ResumeTakesAMovedBakeByItsHashAndNoOther) {
  write_protocol("\"HiRes\"");
  ASSERT_EQ(bake().exit_code, 0);
  const std::string moved = folder_ / "moved", file = moved + "/dam_64_HiRes.bake";
  for (const bool single : {false, true}) {
    const std::string database = folder_ / (single ? "file.db" : "folder.db");
    const std::string place = single ? bakes_ + "/dam_64_HiRes.bake" : bakes_;
    ASSERT_EQ(run(database, {"--stimulus", place}).exit_code, 0);
    study::Store(database, study::sqlite::Open::Write).repeat_trial(1, 1, "shown once more");
    fs::rename(bakes_, moved);
    const std::string hash = sim::BakeReader(file).content_hash();
    const auto resume = [&](std::vector<std::string> more) {
      more.insert(more.begin(), {vip_study, "resume", "--db", database});
      return run_program(more);
    };
    const Ended gone = resume({});
    EXPECT_EQ(gone.exit_code, 1);
    EXPECT_THAT(gone.err, AllOf(HasSubstr(place + ": does not exist any more"), HasSubstr(hash),
                                HasSubstr("vip-study resume --db " + database + " --stimulus PATH")));
    // A bake whose hash differs from that of the bake with which the session began is refused.
    const std::string other = folder_ / "other.bake";
    const auto baked = run_program(
        {vip_study, "bake", scene_, "--method", "HiRes", "--n-star", "64", "--frames", "12", "--out", other});
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
    const Ended refused = resume({"--stimulus", other});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("holds bake " + sim::BakeReader(other).content_hash()),
                                   HasSubstr("began with bake " + hash)));
    const Ended done = resume({"--stimulus", single ? file : moved});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(count_in(database, "SELECT count(*) FROM presentation WHERE state = 'played'"), 2);
    fs::remove(other);
    fs::rename(moved, bakes_);
  }
}

TEST_F(StimulusFolderE2e, AFolderWithoutBakesOfTheProtocolIsRefused) {
  write_protocol("\"HiRes\"");
  fs::create_directory(bakes_);
  const Ended ended = run_baked();
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("holds no bake of this protocol"), HasSubstr("vip-study bake")));
}

TEST_F(StimulusFolderE2e, PicturesThatDifferWithinASceneAreRefusedUnlessTheProtocolAcceptsThem) {
  write_protocol("\"LoRes\", \"FovFluid\"");
  ASSERT_EQ(bake({"--keep", "pictures"}).exit_code, 0);
  const Ended alike = run(folder_ / "alike.db", {"--stimulus", bakes_});
  EXPECT_EQ(alike.exit_code, 0) << alike.err;
  const Ended refused = run_baked("128x72");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("pictures that are compared differ"),
                                 HasSubstr("size 64x36 and 128x72"), HasSubstr("accept_mixed_pictures")));
  EXPECT_FALSE(fs::exists(database_));

  write_protocol("\"LoRes\", \"FovFluid\"", "accept_mixed_pictures = true\n");
  const Ended accepted = run_baked("128x72");
  ASSERT_EQ(accepted.exit_code, 0) << accepted.err;
  EXPECT_THAT(accepted.err, HasSubstr("which the protocol accepts: " + scene_ + ": size 64x36 and 128x72"));
  EXPECT_EQ(found("SELECT cells || ', ' || width_px || ', ' || coalesce(copied, 'drawn') FROM framing "
                  "ORDER BY 1"),
            "0, 64, 0\n1, 128, drawn\n");
}

TEST_F(StimulusFolderE2e, WhereFixationIsPrescribedNoOtherGazeIsTaken) {
  write_protocol("\"LoRes\"", fixation_);
  for (const std::string gaze : {"none", "tracked"}) {
    const Ended ended = run(database_, {"--gaze", gaze});
    EXPECT_EQ(ended.exit_code, 1);
    EXPECT_THAT(ended.err, HasSubstr("contradicts gaze = \"fixation\" of the protocol"));
  }
}

}  // namespace
}  // namespace apps::test
