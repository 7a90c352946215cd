/// A user's own design from check to report: the programs say what they cannot analyse, and everything else
/// is correct.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/new_file.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/report_walk.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps::test {
namespace {

using report_walk::Json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Ended typed(const std::string& line) { return run_shell(VIP_BIN_DIR "/" + line); }

std::string file(const std::filesystem::path& path) { return base::read_file(path, 1 << 24); }

TEST(OwnDesignE2e, GoesFromCheckToReportWithNothingFalse) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const std::string protocol = base::resource("tests/protocols/own_design.toml").string();

  const auto checked = typed("vip-study check " + protocol);
  EXPECT_EQ(checked.exit_code, 0) << checked.out;
  EXPECT_THAT(checked.out, HasSubstr("each break 60 s longer than it must be"));

  // Methods and questions that the protocol lacks are not frozen.
  const auto frozen = typed("vip-stats preregister " + protocol + " --out " + at("bundle"));
  ASSERT_EQ(frozen.exit_code, 0) << frozen.out;
  EXPECT_THAT(frozen.out, HasSubstr("not tested: H1 to H3 of comfort"));
  EXPECT_EQ(Json::parse(file(folder / "bundle" / "hypotheses.json")), Json::array());
  const std::string words = file(folder / "bundle" / "PREREGISTRATION.txt");
  EXPECT_THAT(words,
              HasSubstr("None.\n- Not tested: H1 to H3 of comfort: the trials ask no question 'realism'"));
  EXPECT_THAT(words, HasSubstr("- Not tested: H4 to H6 of comfort: no pairs of methods are shown.\n"));
  EXPECT_THAT(words, Not(HasSubstr("FovFluid")));
  // plan.toml has rules without effect only as comments.
  for (const char* rule :
       {"\nrealism = ", "\nsickness = ", "\nmin_catch_correct = ", "\nmax_repeat_difference = "})
    EXPECT_THAT(file(folder / "bundle" / "plan.toml"), Not(HasSubstr(rule)));
  EXPECT_THAT(words, HasSubstr("# cannot act, as there are no catch pages: min_catch_correct = 0.5\n"));

  const auto power = typed("vip-stats power " + protocol + " --n 24");
  EXPECT_EQ(power.exit_code, 1) << power.out;
  EXPECT_THAT(power.out, HasSubstr("comfort"));

  const auto ran = typed("vip-study run " + protocol + " --db " + at("s.db") +
                         " --participants 24 --observer random --seed 3");
  ASSERT_EQ(ran.exit_code, 0) << ran.out;
  const auto exported = typed("vip-study export --db " + at("s.db") + " --csv " + at("csv"));
  EXPECT_EQ(exported.exit_code, 0) << exported.out;

  const auto reported = typed("vip-stats report " + at("s.db") + " --html " + at("r.html") + " --json " +
                              at("r.json") + " --csv " + at("tables") + " --preregistered " + at("bundle"));
  ASSERT_EQ(reported.exit_code, 0) << reported.out;
  const Json json = Json::parse(file(folder / "r.json"));
  const auto page = html_reader::read(file(folder / "r.html"));
  EXPECT_THAT(report_walk::wrong_fields(page, json), IsEmpty());
  EXPECT_THAT(report_walk::unmarked_numbers(page, json), IsEmpty());
  EXPECT_EQ(report_walk::sessions_in_flows(json), 24);
  EXPECT_EQ(json.at("roster").at("participants"), 24);
  EXPECT_EQ(json.at("flow").at("own").at("analysed"), 24);
  EXPECT_EQ(json.at("study").at("simulated"), 24);
  EXPECT_EQ(json.at("timing").size(), 6u);
  ASSERT_EQ(json.at("descriptives").size(), 2u);
  for (const auto& question : json.at("descriptives")) {
    ASSERT_EQ(question.at("cells").size(), 6u);
    for (const auto& cell : question.at("cells")) EXPECT_EQ(cell.at("n"), 24);
  }
  // A question outside the trials is described too.
  const Json& tired = json.at("people").at(0).at("questions").at(0);
  EXPECT_EQ(tired.at("question"), "tired");
  EXPECT_EQ(tired.at("n"), 24);
  EXPECT_TRUE(tired.at("mean").is_number());
  EXPECT_THAT(file(folder / "tables" / "people.csv"), HasSubstr("tired"));
  const std::string html = file(folder / "r.html");
  EXPECT_NE(html.find("Simulated participants"), std::string::npos);
  EXPECT_NE(html.find("How tired are you?"), std::string::npos);
  EXPECT_NE(html.find("Rules of exclusion for Own design: trials whose timing"), std::string::npos);
  EXPECT_EQ(html.find("catch pages right"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "tables" / "descriptives.csv"));

  // The commands of the paper's tasks say that they do not apply, and what to do.
  for (const char* command : {"fit-ptpe", "task1", "task2"}) {
    const auto refused = typed(std::string("vip-stats ") + command + " " + at("s.db"));
    EXPECT_EQ(refused.exit_code, 1) << refused.out;
    EXPECT_THAT(refused.out, HasSubstr("the database holds no protocol that shows"));
    EXPECT_THAT(refused.out, HasSubstr("this one holds comfort 1.0, which vip-stats report describes"));
  }
  const auto level = typed("vip-stats task1 " + at("s.db") + " --level 3");
  EXPECT_EQ(level.exit_code, 1);
  EXPECT_THAT(level.out, HasSubstr("--level: does not apply to task1"));
}

TEST(OwnDesignE2e, AMendedVersionStandsBesideTheFirst) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const std::string text = protocol_text("own_design");
  base::write_file_atomically(folder / "first.toml", text);
  base::write_file_atomically(folder / "mended.toml",
                              replaced(replaced(text, "\"1.0\"", "\"1.1\""), "Watch the water", "Watch it"));
  for (const auto& [protocol, people] : {std::pair{"first.toml", "2"}, {"mended.toml", "3"}}) {
    const auto ran = typed("vip-study run " + at(protocol) + " --db " + at("s.db") + " --participants " +
                           people + " --observer random");
    ASSERT_EQ(ran.exit_code, 0) << ran.out;
  }
  const auto report = [&](const std::string& more) {
    return typed("vip-stats report " + at("s.db") + " --json " + at("r.json") + more);
  };
  const auto both = report(" --csv " + at("tables") + " --html " + at("r.html"));
  ASSERT_EQ(both.exit_code, 0) << both.out;
  Json json = Json::parse(file(folder / "r.json"));
  EXPECT_EQ(report_walk::sessions_in_flows(json), 5);
  ASSERT_EQ(json.at("apart").size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(folder / "tables" / "apart_1" / "descriptives.csv"));
  const auto page = html_reader::read(file(folder / "r.html"));
  EXPECT_THAT(report_walk::wrong_fields(page, json), IsEmpty());
  EXPECT_THAT(report_walk::unmarked_numbers(page, json), IsEmpty());

  const std::string sha256 = json.at("apart").at(0).at("study").at("protocols").at(0).at("sha256");
  const auto one = report(" --protocol " + sha256.substr(0, 8) + " --question strain");
  ASSERT_EQ(one.exit_code, 0) << one.out;
  json = Json::parse(file(folder / "r.json"));
  EXPECT_EQ(json.at("flow").at("own").at("started"), 2);
  EXPECT_EQ(json.at("descriptives").size(), 1u);
  const auto none = report(" --protocol 00000000");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.out, HasSubstr("choose one with --protocol: comfort 1.0 "));
  const auto no_question = report(" --question nosuch");
  EXPECT_EQ(no_question.exit_code, 1);
  EXPECT_THAT(no_question.out, HasSubstr("choose one with --question: comfort, strain"));
  // A level applies only to a pilot's curve.
  const auto level = report(" --level 2");
  EXPECT_EQ(level.exit_code, 1);
  EXPECT_THAT(level.out, HasSubstr("--level: does not apply here"));
}

// The shipped protocol asks for sickness in its trials too.
TEST(OwnDesignE2e, ThePilotOfALaboratoryReachesTheReport) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const auto protocol = base::resource("protocols/ptpe_pilot_lab.toml").string();
  const auto ran = typed("vip-study run " + protocol + " --db " + at("s.db") +
                         " --participants 3 --observer ptpe:a=24,b=0.02");
  ASSERT_EQ(ran.exit_code, 0) << ran.out;
  const auto fitted = typed("vip-stats fit-ptpe " + at("s.db") + " --json " + at("fit.json"));
  const auto reported =
      typed("vip-stats report " + at("s.db") + " --html " + at("r.html") + " --json " + at("r.json"));
  ASSERT_EQ(reported.exit_code, 0) << reported.out;
  const Json json = Json::parse(file(folder / "r.json"));
  EXPECT_EQ(json.at("flow").at("pilot").at("started"), 3);
  EXPECT_EQ(json.at("pilot").at("question"), "satisfaction");
  const Json fit = Json::parse(file(folder / "fit.json"));
  EXPECT_EQ(fit.at("level"), json.at("pilot").at("level"));
  EXPECT_EQ(fit.at("cells"), json.at("pilot").at("cells"));
  const auto page = html_reader::read(file(folder / "r.html"));
  EXPECT_THAT(report_walk::wrong_fields(page, json), IsEmpty());
  EXPECT_THAT(report_walk::unmarked_numbers(page, json), IsEmpty());
}

}  // namespace
}  // namespace apps::test
