/// Public exports hold only people whose data may be shared; the lab's own export lists who they are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <zlib.h>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "stats/base/json.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char *refuser = "QXJ7refuses", *silent = "QXJ8silent";

/// P01 allows sharing, one person refuses, one allows it at the first visit and refuses at the second, one
/// has not answered, P05 was not asked.
fs::path make_study(const test::TemporaryFolder& folder) {
  Store store(folder / "study.db", Open::Create);
  test::add_people(store, test::asking_protocol(),
                   {{"P01", 1, 1}, {refuser, 1, 0}, {"QXJ9later", 1, 1}, {silent, {}, {}}});
  test::add_people(store, test::asking_protocol(), {{"QXJ9later", 1, 0}}, 2);
  test::add_people(store, test::asking_protocol(true, false), {{"P05", 1, {}}});
  return folder / "study.db";
}

/// Files whose name or bytes contain any of the texts.
std::vector<std::string> files_with(const fs::path& folder, const std::vector<std::string>& texts) {
  std::vector<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().string();
    const std::string all = name + (entry.is_regular_file() ? test::bytes_of(entry.path()) : "");
    for (const std::string& text : texts) {
      if (all.find(text) != std::string::npos) found.push_back(name);
    }
  }
  return found;
}

void expect_left_out(const SharingCount& people) {
  EXPECT_EQ(people.allowed, 1);
  EXPECT_EQ(people.not_asked, 1);
  EXPECT_EQ(people.refused, 2);
  EXPECT_EQ(people.not_answered, 1);
}

TEST(PublicExport, HoldsNoByteOfWhoRefusesOrHasNotAnswered) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  expect_left_out(export_bids(path, folder / "bids", true).people);
  expect_left_out(export_psych_ds(path, folder / "psych").people);
  for (const char* name : {"bids", "psych"}) {
    EXPECT_THAT(files_with(folder / name, {"QXJ"}), IsEmpty());
    EXPECT_THAT(files_with(folder / name, {"P01"}), Not(IsEmpty()));
    EXPECT_THAT(files_with(folder / name, {"P05"}), Not(IsEmpty()));
  }
}

TEST(PublicExport, FollowsTheLaterChange) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  change_permissions(path, "P01", {.gaze = {}, .sharing = false});
  change_permissions(path, refuser, {.gaze = {}, .sharing = true});
  export_bids(path, folder / "bids");
  EXPECT_THAT(files_with(folder / "bids", {"P01"}), IsEmpty());
  EXPECT_THAT(files_with(folder / "bids", {refuser}), Not(IsEmpty()));
}

TEST(PublicExport, OfAnEarlierSchemaLeavesOutWhoRefusedThen) {
  const test::TemporaryFolder folder;
  const fs::path fixture = fs::path(VIP_TEST_DIR) / "libstudy/fixtures/study_v2.db";
  fs::copy_file(fixture, folder / "study.db");
  const PublicExport done = export_bids(folder / "study.db", folder / "bids");
  EXPECT_EQ(done.people.allowed, 4);
  EXPECT_EQ(done.people.refused, 5);
  std::vector<std::string> people;
  for (const auto& entry : fs::directory_iterator(folder / "bids")) {
    const std::string name = entry.path().filename();
    if (name.starts_with("sub-")) people.push_back(name);
  }
  EXPECT_THAT(people, ::testing::UnorderedElementsAre("sub-P03", "sub-P06", "sub-P07", "sub-P09"));
  EXPECT_THAT(files_with(folder / "bids", {"P01", "P02", "P04", "P05", "P08"}), IsEmpty());
}

TEST(OwnExport, SaysWhoMayBeShared) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  export_csv(path, folder / "csv");
  const std::string sessions = test::bytes_of(folder / "csv/sessions.csv");
  EXPECT_THAT(sessions.substr(0, sessions.find('\r')), ::testing::EndsWith(",sharing_allowed,gaze_allowed"));
  std::vector<std::string> ends;
  for (auto at = sessions.find("\r\n"); at != std::string::npos; at = sessions.find("\r\n", at + 1)) {
    const auto line = sessions.substr(0, at);
    ends.push_back(line.substr(line.rfind(',', line.rfind(',') - 1)));
  }
  // The rows are of P01, the refuser, both visits of the person who refuses later, the person without an
  // answer, and P05, who was not asked.
  EXPECT_THAT(ends,
              ElementsAre(",sharing_allowed,gaze_allowed", ",1,1", ",0,1", ",0,1", ",0,0", ",0,1", ",,1"));
  const std::string dictionary = test::bytes_of(folder / "csv/dictionary.csv");
  EXPECT_THAT(dictionary, HasSubstr("\nsessions.csv,sharing_allowed,INTEGER,"));
  EXPECT_THAT(dictionary, HasSubstr("\nsessions.csv,gaze_allowed,INTEGER,"));
  EXPECT_THAT(dictionary, HasSubstr("\npermission_changes.csv,granted,INTEGER,"));
}

std::string unzipped(const fs::path& path) {
  gzFile file = gzopen(path.c_str(), "rb");
  std::string text(1 << 16, '\0');
  text.resize(static_cast<std::size_t>(gzread(file, text.data(), static_cast<unsigned>(text.size()))));
  gzclose(file);
  return text;
}

class GazeExport : public ::testing::Test {
 protected:
  /// The first presentation of three people has gaze: P01's of an eye tracker, P05's and the refuser's of a
  /// mouse.
  GazeExport() : path_(make_study(folder_)) {
    Store store(path_, Open::Write);
    const std::vector<GazeSample> samples{{10'000'000, 3, true, GazePoint{0.25, 0.5}},
                                          {20'000'000, 4, false, {}},
                                          {30'000'000, 5, true, GazePoint{0.5, 0.75}}};
    for (const auto& [who, origin] :
         {std::pair{"P01", GazeOrigin::Tracker}, std::pair{"P05", GazeOrigin::Mouse},
          std::pair{refuser, GazeOrigin::Mouse}}) {
      const auto id =
          test::column(path_,
                       "SELECT min(presentation_id) FROM presentation JOIN trial USING (trial_id) "
                       "JOIN session USING (session_id) WHERE participant = '" +
                           std::string(who) + "'");
      store.add_gaze(std::stoll(id.at(0)), 0, origin, samples);
    }
  }

  test::TemporaryFolder folder_;
  fs::path path_;
};

TEST_F(GazeExport, IsWrittenOnRequestAlone) {
  export_csv(path_, folder_ / "csv");
  EXPECT_FALSE(fs::exists(folder_ / "csv/gaze.csv"));
  export_bids(path_, folder_ / "bids");
  EXPECT_THAT(files_with(folder_ / "bids", {"physio", "acq-mouse"}), IsEmpty());
  export_csv(path_, folder_ / "csv", {.words = false, .gaze = true});
  EXPECT_THAT(test::bytes_of(folder_ / "csv/gaze.csv"),
              ::testing::StartsWith("presentation_id,sample_index,source,sampled_ns,device_ns,valid,x,y,"
                                    "tracked,origin_x_m,origin_y_m,origin_z_m,direction_x,direction_y,"
                                    "direction_z\r\n1,0,tracker,10000000,3,1,0.25,0.5,,,,,,,\r\n"
                                    "1,1,tracker,20000000,4,0,,,,,,,,,\r\n"));
  EXPECT_THAT(test::bytes_of(folder_ / "csv/dictionary.csv"), HasSubstr("\ngaze.csv,source,TEXT,"));
}

TEST_F(GazeExport, BidsHoldsTheEyeAsAnEyeAndTheMouseAsBehaviour) {
  export_bids(path_, folder_ / "bids", true);
  const fs::path eye =
      folder_ / "bids/sub-P01/ses-askingv1/beh/sub-P01_ses-askingv1_task-asking_recording-eye1_physio";
  EXPECT_EQ(unzipped(eye.string() + ".tsv.gz"),
            "0.01\t0.25\t0.5\t1\n0.02\tn/a\tn/a\t0\n0.03\t0.5\t0.75\t1\n");
  const auto json = base::Json::parse(test::bytes_of(eye.string() + ".json"));
  EXPECT_EQ(json["PhysioType"], "eyetrack");
  EXPECT_EQ(json["RecordedEye"], "cyclopean");
  EXPECT_EQ(json["SampleCoordinateSystem"], "gaze-on-screen");
  EXPECT_DOUBLE_EQ(json["SamplingFrequency"].get<double>(), 100);
  EXPECT_DOUBLE_EQ(json["StartTime"].get<double>(), 0.01);
  EXPECT_EQ(json["Columns"].dump(), R"(["timestamp","x_coordinate","y_coordinate","valid"])");
  for (const auto& column : json["Columns"])
    EXPECT_TRUE(json[column.get<std::string>()].contains("Description"));

  const fs::path beh = folder_ / "bids/sub-P05";
  EXPECT_THAT(files_with(beh, {"physio", "eyetrack"}), IsEmpty());
  const auto tables = files_with(beh, {"_acq-mouse_beh.tsv"});
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(test::bytes_of(tables[0]),
            "timestamp\tx_coordinate\ty_coordinate\tvalid\n0.01\t0.25\t0.5\t1\n0.02\tn/a\tn/"
            "a\t0\n0.03\t0.5\t0.75\t1\n");
  EXPECT_THAT(files_with(folder_ / "bids", {"QXJ"}), IsEmpty());
}

}  // namespace
}  // namespace study
