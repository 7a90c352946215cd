/// Exports follow the rules of BIDS 1.11 and Psych-DS, and the checks of the rules detect violations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "tests/common/bids_rules.hpp"
#include "tests/common/psych_ds_rules.hpp"
#include "tests/libstudy/gaze_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::test::BidsRules;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ExportRules : public ::testing::Test {
 protected:
  ExportRules() {
    const fs::path database = test::make_gaze_study(folder_);
    export_bids(database, bids_, true);
    export_psych_ds(database, psych_);
  }
  /// Changes a JSON file of an export.
  static void change(const fs::path& path, const std::function<void(base::Json&)>& how) {
    base::Json json = ::test::json_at(path);
    ASSERT_TRUE(json.is_object()) << path;
    how(json);
    base::write_file_atomically(path, json.dump());
  }

  test::TemporaryFolder folder_;
  fs::path bids_ = folder_ / "bids", psych_ = folder_ / "psych";
  std::string session_ = "sub-P01/ses-askingv1/beh/sub-P01_ses-askingv1_task-asking";
};

TEST_F(ExportRules, OfBidsHoldForGazeOfEyeAndMouse) {
  EXPECT_TRUE(fs::exists(bids_ / (session_ + "_recording-eye1_physio.tsv.gz")));
  EXPECT_TRUE(
      fs::exists(bids_ / "sub-P02/ses-askingv1/beh/sub-P02_ses-askingv1_task-asking_acq-mouse_beh.tsv"));
  EXPECT_THAT(BidsRules::broken_by(bids_), IsEmpty());
}

TEST_F(ExportRules, OfBidsSeeNonsenseInTheFieldsOfAnEye) {
  const fs::path eye = bids_ / (session_ + "_recording-eye1_physio.json");
  const base::Json sound = ::test::json_at(eye);
  const std::vector<std::pair<std::string, base::Json>> nonsense{
      {"RecordedEye", "third"},        {"SampleCoordinateSystem", "moon"},
      {"SamplingFrequency", 0},        {"StartTime", "noon"},
      {"PhysioType", "guess"},         {"Columns", {"x_coordinate"}},
      {"x_coordinate", {{"Units", 3}}}};
  for (const auto& [key, value] : nonsense) {
    base::Json json = sound;
    json[key] = value;
    base::write_file_atomically(eye, json.dump());
    EXPECT_THAT(BidsRules::broken_by(bids_), Contains(HasSubstr("_physio"))) << key;
  }
  base::write_file_atomically(eye, sound.dump());
  for (const char* key : {"ScreenDistance", "ScreenSize", "ScreenResolution", "ScreenOrigin"}) {
    const fs::path events = bids_ / (session_ + "_events.json");
    const std::string before = test::bytes_of(events);
    change(events, [&](base::Json& json) { json["StimulusPresentation"].erase(key); });
    EXPECT_THAT(BidsRules::broken_by(bids_), Contains(HasSubstr(key)));
    base::write_file_atomically(events, before);
  }
  EXPECT_THAT(BidsRules::broken_by(bids_), IsEmpty());
}

TEST_F(ExportRules, OfBidsSeeFilesAndTablesOutOfPlace) {
  base::write_file_atomically(bids_ / "sessions.json", "{}");
  EXPECT_THAT(BidsRules::broken_by(bids_),
              Contains("sessions.json: has a name that the standard does not know"));
  fs::remove(bids_ / "sessions.json");
  const fs::path people = bids_ / "participants.tsv";
  base::write_file_atomically(people, test::bytes_of(people) + "sub-P03\tP03\n");
  EXPECT_THAT(BidsRules::broken_by(bids_), Contains(HasSubstr("every folder sub-*")));
  EXPECT_THAT(BidsRules::broken_by(bids_), Contains(HasSubstr("phenotype/consent.tsv")));
}

TEST_F(ExportRules, OfPsychDsHoldAndSeeWhatBreaksThem) {
  EXPECT_THAT(::test::psych_ds_broken_by(psych_), IsEmpty());
  change(psych_ / "dataset_description.json",
         [](base::Json& json) { json["variableMeasured"][0]["name"] = "in_no_file"; });
  EXPECT_THAT(::test::psych_ds_broken_by(psych_), Contains("VARIABLE_MISSING_FROM_CSV_COLUMNS in_no_file"));
  EXPECT_THAT(::test::psych_ds_broken_by(psych_), Contains(HasSubstr("CSV_COLUMN_MISSING_FROM_METADATA")));
  base::write_file_atomically(psych_ / "data" / "mine.csv", "a\n1,2\n");
  EXPECT_THAT(::test::psych_ds_broken_by(psych_),
              Contains("FILENAME_KEYWORD_FORMATTING_ERROR data/mine.csv"));
  EXPECT_THAT(::test::psych_ds_broken_by(psych_), Contains("CSV_HEADER_LENGTH_MISMATCH data/mine.csv"));
}

}  // namespace
}  // namespace study
