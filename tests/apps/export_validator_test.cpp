/// Exports of every shipped protocol, and of gaze, against the standards: the public validator of BIDS, and
/// the rules of BIDS 1.11 and Psych-DS (tests/common).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "libstudy/store/export/export_bids.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/bids_rules.hpp"
#include "tests/common/psych_ds_rules.hpp"
#include "tests/libstudy/gaze_fixture.hpp"

namespace {

namespace fs = std::filesystem;
using ::test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// scripts/validate_bids.sh: 0 valid, 1 an error, 77 no validator is installed.
apps::test::Ended validate(const std::vector<fs::path>& folders) {
  std::string line = VIP_TEST_DIR "/../scripts/validate_bids.sh";
  for (const fs::path& folder : folders) line += " " + folder.string();
  return apps::test::run_shell(line);
}

/// Three simulated people in each shipped protocol, exported in both formats.
std::vector<fs::path> export_every_protocol(const TemporaryFolder& folder) {
  std::vector<fs::path> made;
  for (const auto& entry : fs::directory_iterator(base::resource("protocols/task1.toml").parent_path())) {
    const std::string name = entry.path().stem().string(), database = (folder / (name + ".db")).string();
    const std::string study = VIP_BIN_DIR "/vip-study ";
    const std::string run = "run " + entry.path().string() + " --participants 3 --observer random --seed 3";
    const std::string out =
        " --bids " + (folder / name).string() + " --psych-ds " + (folder / name).string() + "_psych";
    const auto ended = apps::test::run_shell(study + run + " --db " + database + " && " + study +
                                             "export --gaze --db " + database + out);
    EXPECT_EQ(ended.exit_code, 0) << name << ": " << ended.out;
    made.push_back(folder / name);
  }
  return made;
}

TEST(ExportValidatorE2e, EveryShippedProtocolHoldsTheRules) {
  const TemporaryFolder folder;
  const auto exports = export_every_protocol(folder);
  EXPECT_THAT(exports, SizeIs(8));
  for (const fs::path& bids : exports) {
    EXPECT_THAT(::test::BidsRules::broken_by(bids), IsEmpty()) << bids;
    EXPECT_THAT(::test::psych_ds_broken_by(bids.string() + "_psych"), IsEmpty()) << bids;
  }
}

TEST(ExportValidatorE2e, EveryShippedProtocolAndGazePassThePublicValidator) {
  const TemporaryFolder folder;
  auto exports = export_every_protocol(folder);
  exports.push_back(folder / "gaze");
  study::export_bids(study::test::make_gaze_study(folder), exports.back(), true);
  const auto ended = validate(exports);
  if (ended.exit_code == 77) GTEST_SKIP() << ended.out;
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_THAT(ended.out, Not(HasSubstr("[ERR]")));
  base::write_file_atomically(exports.back() / "sessions.json", "{}");
  EXPECT_EQ(validate({exports.back()}).exit_code, 1) << "the validator sees an error";
}

}  // namespace
