/// vip-study run --display openxr with a person: the scripted hand, eyes and stick of the simulated headset
/// answer the pages.
#include <array>
#include <regex>
#include <sstream>

#include "libstudy/store/sqlite.hpp"
#include "tests/apps/headset_runs.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// Where a page of the pilot has "yes", a score of 4, and the button to go on: parts of it from its left and
/// its top.
const std::string pilot_targets = "targets=0.5:0.525,0.5:0.39,0.5:0.9";
const std::string by_ray = "point=page;hold=0.4;" + pilot_targets;
const std::string by_dwell = "look=page;hold=1.2;blink_every=0.8;blink_length=0.1;" + pilot_targets;

class HeadsetPersonE2e : public test::HeadsetRuns {
 protected:
  void SetUp() override {
    const auto baked =
        test::run_program({bin + "/vip-study", "bake", "data/scenes/single_dam.toml", "--method", "HiRes",
                           "--n-star", "64", "--frames", "30", "--out", dam_});
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
  }

  /// The pilot with these means, played although some are approximate; five seconds on the first page are
  /// one.
  std::string pilot(const std::string& means) {
    std::string text = test::short_protocol("10");
    text = test::replaced(text, "mean_fps = [20, 50]", "mean_fps = " + means);
    text = test::replaced(text, "sd_fps = [0, 5, 10]", "sd_fps = [0]");
    text = test::replaced(text, "accept_approximate = false", "accept_approximate = true");
    text = test::replaced(text, "seconds = 5 ", "seconds = 1 ");
    base::write_file_atomically(folder_ / "pilot.toml", text);
    return folder_ / "pilot.toml";
  }

  std::vector<std::string> arguments(const std::string& protocol, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{
        "run",     protocol,  "--db",       database_, "--participant",   "P01", "--display", "openxr",
        "--clock", "virtual", "--stimulus", dam_,      "--trial-seconds", "0.5", "--events"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  test::Ended session(const std::string& profile, const std::string& protocol,
                      const std::vector<std::string>& more = {}) {
    return study("size=32x32;" + profile, arguments(protocol, more));
  }

  /// One value of each row, in order.
  std::vector<std::string> column(const std::string& sql) const {
    study::sqlite::Connection database(database_, study::sqlite::Open::Read);
    study::sqlite::Statement row(database, sql);
    std::vector<std::string> all;
    while (row.step()) all.push_back(row.text(0));
    return all;
  }

  const std::string dam_ = folder_ / "dam.bake";
  const std::string database_ = folder_ / "study.db";
};

/// Degrees from edge to edge of each quad of the log, to an eye 1.5 m ahead of its middle.
std::set<int> page_widths(const std::string& log) {
  std::set<int> widths;
  const std::regex size(R"(\| quad .* size ([0-9.]+) )");
  std::istringstream lines(log);
  std::smatch found;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, found, size))
      widths.insert(static_cast<int>(std::lround(2 * std::atan(std::stod(found[1]) / 3) * 57.29578)));
  }
  return widths;
}

TEST_F(HeadsetPersonE2e, ThePilotIsAnsweredByARay) {
  const auto ended = session(by_ray, pilot("[10, 30]"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("2 of 2 trials answered"));
  EXPECT_THAT(ended.out, HasSubstr("2 of 2 trials pass"));
  EXPECT_THAT(column("SELECT score FROM response ORDER BY response_id"),
              ::testing::ElementsAre("1", "4", "4"));
  EXPECT_THAT(column("SELECT test_data FROM session"), ::testing::ElementsAre("1"));
  EXPECT_EQ(page_widths(calls()), std::set<int>{38});
}

TEST_F(HeadsetPersonE2e, ThePilotIsAnsweredByTheEyesAlone) {
  const auto ended = session(by_dwell, pilot("[10]"), {"--answer", "dwell"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("1 of 1 trials answered"));
  EXPECT_THAT(column("SELECT score FROM response ORDER BY response_id"), ::testing::ElementsAre("1", "4"));
}

}  // namespace
}  // namespace apps
