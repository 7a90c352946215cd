/// vip-stats report and preregister, run from their command lines.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/report/page.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::test::TemporaryFolder;
using ::testing::HasSubstr;

test::Ended typed(const std::string& line) { return test::run_shell(VIP_BIN_DIR "/" + line); }

TEST(ReportCommandE2e, MakesThePageOfASimulatedPilotFromItsJson) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const auto protocol = base::resource("protocols/ptpe_pilot.toml").string();
  const auto ran = typed("vip-study run " + protocol + " --db " + at("s.db") +
                         " --participants 6 --observer ptpe:a=24,b=0.02 --seed 3");
  ASSERT_EQ(ran.exit_code, 0) << ran.out;
  const auto frozen = typed("vip-stats preregister " + protocol + " --out " + at("bundle"));
  ASSERT_EQ(frozen.exit_code, 0) << frozen.out;
  const auto made = typed("vip-stats report --db " + at("s.db") + " --html " + at("r.html") + " --json " +
                          at("r.json") + " --csv " + at("csv") + " --preregistered " + at("bundle"));
  ASSERT_EQ(made.exit_code, 0) << made.out;
  const auto html = base::read_file(folder / "r.html", 1 << 24);
  const auto json = base::Json::parse(base::read_file(folder / "r.json", 1 << 24));
  EXPECT_TRUE(html == study::report::results_page(json)) << "the page is not made of the JSON alone";
  EXPECT_EQ(json.at("pilot").at("n_participants"), 6);
  EXPECT_NE(html.find("<svg"), std::string::npos);
  // The page says that the bundle was frozen after the answers.
  EXPECT_EQ(json.at("preregistration").at("times").at(0).at("frozen_before"), false);
  EXPECT_NE(html.find("The bundle was not frozen before the first answer of Pilot"), std::string::npos);
  EXPECT_FALSE(json.at("preregistration").at("holds").get<bool>());
  for (const char* alone : {"json", "csv", "html"}) {
    const auto out = at("alone") + "." + alone;
    const auto ended = typed("vip-stats report " + at("s.db") + " --" + alone + " " + out);
    EXPECT_EQ(ended.exit_code, 0) << ended.out;
    EXPECT_TRUE(fs::exists(out)) << out;
  }
}

TEST(ReportCommandE2e, RefusesWhatItCannotReadAndWritesNothing) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const auto missing = typed("vip-stats report " + at("none.db") + " --html " + at("r.html"));
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.out, HasSubstr("none.db"));
  const auto onto = typed("vip-stats report " + at("s.db") + " --html " + at("s.db"));
  EXPECT_EQ(onto.exit_code, 1);
  EXPECT_THAT(onto.out, HasSubstr("is the database"));
  const auto no_page = typed("vip-stats report " + at("s.db"));
  EXPECT_EQ(no_page.exit_code, 2);
  const auto no_protocol = typed("vip-stats preregister " + at("none.toml") + " --out " + at("bundle"));
  EXPECT_EQ(no_protocol.exit_code, 1);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace apps
