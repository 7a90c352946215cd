/// Exports of headset data to tables and to BIDS, as far as the person allows it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "stats/base/json.hpp"
#include "tests/common/bids_rules.hpp"
#include "tests/libstudy/headset_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(HeadsetExports, AreExportedOnlyWithGazeWhereTheyTellOfAPerson) {
  const test::TemporaryFolder folder;
  const fs::path path = test::headset_study(folder, "study.db", {{"P01", 1, 1}});
  export_csv(path, folder / "few");
  for (const char* file : {"headsets.csv", "ipds.csv", "slots.csv"})
    EXPECT_TRUE(fs::exists(folder / "few" / file));
  for (const char* file : {"heads.csv", "gaze.csv", "gaze_validations.csv"})
    EXPECT_FALSE(fs::exists(folder / "few" / file)) << file;
  export_csv(path, folder / "all", {.words = false, .gaze = true});
  EXPECT_THAT(test::bytes_of(folder / "all/heads.csv"),
              HasSubstr("\r\n1,0,0.5,1.5,-0.25,0,0.6,0,0.8,1,0\r\n"));
  EXPECT_THAT(test::bytes_of(folder / "all/gaze_validations.csv"),
              HasSubstr("\r\n1,1,0,8,10,-10,30,29,0.5,0.25,0.125,1\r\n"));
  EXPECT_THAT(test::bytes_of(folder / "all/dictionary.csv"), HasSubstr("\nheads.csv,quat_w,REAL,"));
}

TEST(HeadsetExports, AreMotionAndAnEyeInTheHeadInBids) {
  const test::TemporaryFolder folder;
  const fs::path path = test::headset_study(folder, "study.db", {{"P01", 1, 1}, {"P02", 0, 1}});
  {
    Store store(path, Open::Write);
    const GazeSample blink{10'000'005, {}, false, {}, false, {}};
    store.add_gaze(1, 0, GazeOrigin::Tracker, {&blink, 1});
    ShownSlot slot{test::slot_at(10'000'006), 1};
    slot.slot.head->place_valid = false;
    store.add_slots(1, 0, {&slot, 1});
  }
  const std::string session = "sub-P01/ses-askingv1/", stem = "sub-P01_ses-askingv1_task-asking";
  export_bids(path, folder / "few");
  EXPECT_FALSE(fs::exists(folder / "few" / session / "motion"));
  export_bids(path, folder / "bids", true);
  EXPECT_THAT(::test::BidsRules::broken_by(folder / "bids"), IsEmpty());
  const fs::path motion = folder / "bids" / session / "motion" / (stem + "_tracksys-headset_");
  EXPECT_EQ(test::bytes_of(motion.string() + "motion.tsv"),
            "6e-09\t0.5\t1.5\t-0.25\t0\t0.6\t0\t0.8\t1\t0\n"
            "0.010000006\tn/a\tn/a\tn/a\t0\t0.6\t0\t0.8\t0\t0\n");
  EXPECT_THAT(test::bytes_of(motion.string() + "channels.tsv"), HasSubstr("\nquat_w\tquat_w\tORNT\thead\t"));
  const auto eye = base::Json::parse(
      test::bytes_of(folder / "bids" / session / "beh" / (stem + "_recording-eye1_physio.json")));
  EXPECT_EQ(eye["SampleCoordinateSystem"], "eye-in-head");
  EXPECT_EQ(eye["AverageCalibrationError"], 0.5);
  const auto events =
      base::Json::parse(test::bytes_of(folder / "bids" / session / "beh" / (stem + "_events.json")));
  EXPECT_EQ(events["StimulusPresentation"]["HeadMountedDisplay"]["headset"], "a headset");
  EXPECT_EQ(events["StimulusPresentation"]["HeadMountedDisplay"]["ipd_mm"][0], 63);
  EXPECT_FALSE(fs::exists(folder / "bids/sub-P02/ses-askingv1/motion")) << "refused gaze";
}

TEST(HeadsetExports, OfASingleSampleHaveTheDisplaysRateInBidsOrNoPlaceThere) {
  const test::TemporaryFolder folder;
  const fs::path path = test::headset_study(folder, "study.db", {{"P01", 1, 1}});
  const std::string session = "sub-P01/ses-askingv1/", stem = "sub-P01_ses-askingv1_task-asking";
  const std::vector<std::string> recordings{"motion/" + stem + "_tracksys-headset_motion",
                                            "beh/" + stem + "_recording-eye1_physio"};
  export_bids(path, folder / "bids", true);
  EXPECT_THAT(::test::BidsRules::broken_by(folder / "bids"), IsEmpty());
  for (const std::string& recording : recordings) {
    const auto json = base::Json::parse(test::bytes_of(folder / "bids" / session / (recording + ".json")));
    EXPECT_EQ(json["SamplingFrequency"], 89.5);
  }
  Connection(path, Open::Write).execute("DELETE FROM headset; UPDATE session SET refresh_hz = NULL");
  export_bids({path, true}, folder / "unknown", true);
  EXPECT_THAT(::test::BidsRules::broken_by(folder / "unknown"), IsEmpty());
  for (const std::string& recording : recordings)
    EXPECT_FALSE(fs::exists(folder / "unknown" / session / (recording + ".json"))) << recording;
}

TEST(HeadsetExports, OfAHeadThatStoodInAreBehaviourInBids) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  {
    Store store(path, Open::Create);
    test::add_people(store, test::asking_protocol(), {{"P01", 1, 1}});
    store.add_headset(1, test::headset_facts());
    const std::vector<GazeSample> samples{{10'000'000, {}, false, {}, false, {}},
                                          {20'000'000, {}, true, GazePoint{0.5, 0.25}, true, GazeRay{}}};
    store.add_gaze(1, 0, GazeOrigin::Head, samples);
  }
  export_bids(path, folder / "bids", true);
  EXPECT_THAT(::test::BidsRules::broken_by(folder / "bids"), IsEmpty());
  const fs::path head =
      folder / "bids/sub-P01/ses-askingv1/beh/sub-P01_ses-askingv1_task-asking_acq-head_beh";
  EXPECT_EQ(test::bytes_of(head.string() + ".tsv"),
            "timestamp\tx_coordinate\ty_coordinate\tvalid\ttracked\n"
            "0.01\tn/a\tn/a\t0\t0\n0.02\t0.5\t0.25\t1\t1\n");
  const auto json = base::Json::parse(test::bytes_of(head.string() + ".json"));
  EXPECT_THAT(json["Description"].get<std::string>(), HasSubstr("No eye was recorded"));
  EXPECT_FALSE(fs::exists(folder / "bids/sub-P01/ses-askingv1/motion")) << "no head pose";
  export_bids(path, folder / "few");
  EXPECT_FALSE(fs::exists(folder / "few/sub-P01/ses-askingv1/beh" / head.filename().concat(".tsv")));
}

}  // namespace
}  // namespace study
