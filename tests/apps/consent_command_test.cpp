/// vip-study consent and export, run from their command lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::HasSubstr;

/// short_protocol with one more box on its consent page, which the observer "constant:0" leaves at no and
/// "constant:1" ticks.
std::string asking_protocol() {
  return with_before(short_protocol("1"), "[[block]]\nkind = \"stimulus\"", R"([[block.question]]
id = "data_shared"
kind = "choice"
text = "May it be shared?"
anchors = {0 = "no", 1 = "yes"}

)");
}

TEST(ConsentCommandE2e, IsToldObeyedAndChanged) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "asking.toml", db = folder / "study.db";
  base::write_file_atomically(protocol, asking_protocol());
  const auto call = [](const std::vector<std::string>& arguments) { return Process(arguments).wait(); };
  for (const auto& [who, says] : {std::pair{"P01", "constant:1"}, std::pair{"P02", "constant:0"}}) {
    const Ended ran = call({vip_study, "run", protocol, "--db", db, "--clock", "virtual", "--display", "none",
                            "--observer", says, "--participant", who});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const std::string note =
        "warning: question 'satisfaction' goes from 1 to 7: the observer gives the nearest score there";
    EXPECT_EQ(ran.err.find(note) != std::string::npos, std::string(says) == "constant:0") << ran.err;
  }
  EXPECT_THAT(call({vip_study, "status", "--db", db}).out, HasSubstr("data not shared"));
  EXPECT_THAT(call({vip_study, "consent", "P02", "--db", db}).out,
              HasSubstr("visit 1: gaze kept not asked, data shared no"));
  const std::vector<std::string> exporting{vip_study, "export",        "--db",       db,
                                           "--bids",  folder / "bids", "--psych-ds", folder / "psych"};
  EXPECT_THAT(call(exporting).out, HasSubstr("1 people are in it; 1 left out: 1 refused"));
  EXPECT_FALSE(fs::exists(folder / "bids" / "sub-P02"));
  EXPECT_TRUE(fs::exists(folder / "bids" / "sub-P01"));

  const Ended changed = call({vip_study, "consent", "P02", "--db", db, "--sharing", "yes"});
  EXPECT_EQ(changed.exit_code, 0) << changed.err;
  EXPECT_THAT(changed.out, HasSubstr("data shared yes"));
  EXPECT_THAT(call(exporting).out, HasSubstr("2 people are in it; 0 left out"));
  EXPECT_TRUE(fs::exists(folder / "bids" / "sub-P02"));
  const Ended unknown = call({vip_study, "consent", "P09", "--db", db, "--gaze", "no"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("mend: "));
  EXPECT_EQ(call({vip_study, "consent", "P02", "--db", db, "--gaze", "perhaps"}).exit_code, 2);
}

}  // namespace
}  // namespace apps::test
