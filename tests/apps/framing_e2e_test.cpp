/// The camera's angle and the visual angle, from the command line to the database.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/gl/png.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class FramingE2e : public ::testing::Test {
 protected:
  FramingE2e() {
    const std::string scene = base::read_file(base::resource("data/scenes/faucet.toml"), 1 << 20);
    base::write_file_atomically(scene_, replaced(scene, "settle_frames = 120", "settle_frames = 1"));
  }
  /// A protocol of short trials with this method. `more`: further keys of the protocol's head.
  void write_protocol(const std::string& method, const std::string& more = "") {
    base::write_file_atomically(
        protocol_, with_before(with_keys(short_protocol("0.2"), {{"scene", "[\"" + scene_ + "\"]"},
                                                                 {"method", "[\"" + method + "\"]"},
                                                                 {"n_star", "[\"64\"]"}}),
                               "participants = ", more));
  }
  Ended run(std::vector<std::string> more) {
    more.insert(more.end(), {"--participants", "1", "--display", "headless", "--backend", "cpu"});
    return run_program(run_arguments(protocol_, database_, more));
  }
  double stored(const std::string& column) {
    study::sqlite::Connection database(database_, study::sqlite::Open::Read);
    study::sqlite::Statement row(database, "SELECT " + column + " FROM framing");
    EXPECT_TRUE(row.step());
    return row.is_null(0) ? -1 : row.real(0);
  }
  std::int64_t test_sessions() {
    return count_in(database_, "SELECT count(*) FROM session WHERE test_data = 1");
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "faucet.toml", protocol_ = folder_ / "short.toml";
  std::string database_ = folder_ / "study.db", bake_ = folder_ / "faucet.bake";
  const std::vector<std::string> desk_{"--size", "64x36", "--screen-width-mm", "520", "--viewing-distance-mm",
                                       "600"};
  const double seen_deg_ = 2 * std::atan(520.0 * 36 / 64 / 2 / 600) * 180 / std::acos(-1.0);
};

TEST_F(FramingE2e, TheCameraStaysAndBothAnglesAreStored) {
  write_protocol("LoRes");
  const Ended ended = run(desk_);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(stored("camera_angle_deg"), 75);
  EXPECT_NEAR(stored("visual_angle_deg"), seen_deg_, 1e-9);
  EXPECT_NEAR(stored("angle_ratio"), seen_deg_ / 75, 1e-9);
  EXPECT_EQ(stored("1.0 * shown_width_px"), 64);
}

// A window fills its monitor, which may be another one when the session is resumed.
TEST_F(FramingE2e, ASessionResumedOnAnotherDisplayKeepsBothFramings) {
  write_protocol("LoRes");
  std::vector<std::string> arguments = desk_;
  arguments.insert(arguments.end(), {"--accept-slow", "--clock", "real", "--display", "headless", "--backend",
                                     "cpu", "--participants", "1"});
  Process process(run_arguments(protocol_, database_, arguments));
  while (const auto line = process.read_line())
    if (line->find("done P01 2 stimulus") == 0) break;
  process.send(SIGINT);
  ASSERT_EQ(process.wait().exit_code, 1);
  study::sqlite::Connection(database_, study::sqlite::Open::Write)
      .execute("UPDATE run SET options = replace(options, '\"width_px\":64', '\"width_px\":48')");
  const Ended resumed = run_program({vip_study, "resume", "--db", database_});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(count_in(database_, "SELECT count(*) FROM framing"), 2);
  const std::string shown =
      "SELECT count(*) FROM presentation JOIN framing USING (framing_id) WHERE width_px = ";
  EXPECT_GT(count_in(database_, shown + "64"), 0);
  EXPECT_GT(count_in(database_, shown + "48"), 0);
  EXPECT_EQ(count_in(database_, "SELECT count(*) FROM presentation WHERE framing_id IS NULL"), 0);
}

TEST_F(FramingE2e, WithoutAScreenTheVisualAngleIsNotKnownAndMethodsThatFollowTheGazeAreTold) {
  write_protocol("FovFluid");
  const Ended ended = run({"--size", "64x36"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("eccentricity is computed from the camera's angle"));
  EXPECT_EQ(stored("camera_angle_deg"), 75);
  EXPECT_EQ(stored("visual_angle_deg"), -1) << "NULL";
  EXPECT_EQ(stored("angle_ratio"), -1) << "NULL";
}

TEST_F(FramingE2e, ATrueAngleThatCutsTheJetIsRefusedBeforeAnythingIsWritten) {
  write_protocol("LoRes", "camera_angle = \"true\"\n");
  const Ended ended = run(desk_);
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("the falling jet leaves the picture"), HasSubstr("mend: ")));
  EXPECT_FALSE(fs::exists(database_));
  const Ended unknown = run({"--size", "64x36"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("--screen-width-mm"));
}

TEST_F(FramingE2e, ATrueAngleThatHoldsItIsTheCameras) {
  write_protocol("LoRes", "camera_angle = \"true\"\n");
  const Ended ended = run({"--size", "64x36", "--screen-width-mm", "1600", "--viewing-distance-mm", "600"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(stored("camera_angle_deg"), stored("visual_angle_deg"));
  EXPECT_GT(stored("camera_angle_deg"), 70);
  EXPECT_EQ(stored("angle_ratio"), 1);
}

TEST_F(FramingE2e, ABakeOfAnotherAngleIsTestDataAndOneOfAnotherSizeIsTold) {
  write_protocol("LoRes", "camera_angle = \"true\"\n");
  const Ended baked =
      run_program({vip_study, "bake", scene_, "--method", "LoRes", "--n-star", "64", "--backend", "cpu",
                   "--frames", "5", "--pictures", "64x36", "--out", bake_});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const Ended ended = run(
      {"--size", "128x72", "--screen-width-mm", "1600", "--viewing-distance-mm", "600", "--stimulus", bake_});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("camera angle 75 deg instead of"), HasSubstr("marked as test data"),
                               HasSubstr("baked pictures of 64x36 px are scaled to 128x72 px")));
  EXPECT_EQ(test_sessions(), 1);
  EXPECT_EQ(stored("camera_angle_deg"), 75) << "the bake's";
  EXPECT_EQ(stored("1.0 * width_px"), 64);
  EXPECT_EQ(stored("1.0 * shown_width_px"), 128);
}

TEST_F(FramingE2e, ABakeThatFollowedTheGazeInTheCamerasAngleIsTestDataWhereTheEyesIsKnown) {
  write_protocol("FovFluid");
  const Ended baked = run_program({vip_study, "bake", scene_, "--method", "FovFluid", "--n-star", "64",
                                   "--backend", "cpu", "--frames", "5", "--out", bake_});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  std::vector<std::string> arguments = desk_;
  arguments.insert(arguments.end(), {"--stimulus", bake_});
  const Ended ended = run(arguments);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("levels by the camera's angle instead of the eye's"));
  EXPECT_EQ(test_sessions(), 1);
}

TEST_F(FramingE2e, CheckShowsBeforeTheFirstParticipantWhatWillBeSeen) {
  write_protocol("LoRes");
  const std::string check = vip_study + " check " + protocol_ +
                            " --size 160x90 --screen-width-mm 520 "
                            "--viewing-distance-mm 600 --preview " +
                            std::string(folder_ / "page") + " --json " + std::string(folder_ / "check.json");
  const Ended kept = run_shell(check);
  ASSERT_EQ(kept.exit_code, 0) << kept.out;
  EXPECT_THAT(kept.out, AllOf(HasSubstr("camera 75 deg"), HasSubstr("27.4"), HasSubstr("(ratio 0.3"),
                              HasSubstr("all that must stay visible is in the picture")));
  const auto json = base::Json::parse(base::read_file(folder_ / "check.json", 1 << 20));
  EXPECT_EQ(json.at("framing").at(0).at("camera_angle_deg"), 75);
  EXPECT_TRUE(json.at("framing").at(0).at("cut").empty());
  const std::string page = base::read_file(folder_ / "page/index.html", 1 << 20);
  EXPECT_THAT(page, AllOf(HasSubstr("Stays in the picture: the falling jet"), HasSubstr("scene_1.png")));
  EXPECT_EQ(sim::read_png(folder_ / "page/scene_1.png").width, 160);

  write_protocol("LoRes", "camera_angle = \"true\"\n");
  const Ended cut = run_shell(check);
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_THAT(cut.out, AllOf(HasSubstr("the falling jet leaves the picture"),
                             Not(HasSubstr("all that must stay visible"))));
  EXPECT_THAT(base::read_file(folder_ / "page/index.html", 1 << 20),
              HasSubstr("Leaves the picture: the falling jet"));
}

}  // namespace
}  // namespace apps::test
