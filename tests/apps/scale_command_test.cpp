/// vip-stats scale: choices and ratings of a database and of CSV files on one scale.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using apps::test::Ended;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string shared = std::string(VIP_TEST_DIR) + "/stats/r/";

base::Json document_at(const fs::path& path) { return base::Json::parse(base::read_file(path, 1 << 24)); }

class ScaleCommandE2e : public ::testing::Test {
 protected:
  Ended scale(const std::string& arguments) const {
    return apps::test::run_shell("cd " + folder_.path().string() + " && " VIP_BIN_DIR "/vip-stats scale " +
                                 arguments);
  }
  void write(const std::string& name, const std::string& text) const {
    base::write_file_atomically(folder_ / name, text);
  }
  void make_study(const std::string& protocol, const std::string& options) const {
    const Ended ended = apps::test::run_shell(VIP_BIN_DIR "/vip-study run " + protocol + " --db " +
                                              (folder_ / "s.db").string() +
                                              " --clock virtual --display none --seed 7 " + options);
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
  }
  ::test::TemporaryFolder folder_;
};

TEST_F(ScaleCommandE2e, EachSceneOfAFileGetsAScaleOfItsOwn) {
  const Ended ended = scale(shared + "tmo_choices.csv --by scene --prior normal --next 2 --json s.json");
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("scene corridor\n7 conditions, 256 choices, 18 people"),
                    HasSubstr("pairs to ask next"), HasSubstr("bab: 63 answers"), Not(HasSubstr("WARNING"))));
  const auto json = document_at(folder_ / "s.json");
  EXPECT_EQ(json.at("schema"), "vip-scale/1");
  ASSERT_EQ(json.at("scales").size(), 5u);
  EXPECT_EQ(json.at("observers").size(), 18u);
  const auto& one = json.at("scales").at(0);
  EXPECT_EQ(one.at("next").size(), 2u);
  EXPECT_EQ(one.at("differences").size(), 21u);
  EXPECT_TRUE(one.at("conditions").at(0).at("ci").is_array());
}

TEST_F(ScaleCommandE2e, APairThatIsProposedOftenStandsOnceWithItsNumber) {
  write("a.csv", "person,first,second,chosen,count\nP1,a,b,first,6\nP1,a,b,second,4\n");
  const Ended ended = scale("a.csv --next 3");
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("pairs to ask next, with the gain of these answers:\n  a, b: 3 answers, 0."),
                    Not(HasSubstr("a, b: 1 answer"))));
}

TEST_F(ScaleCommandE2e, RemediesFitTheReason) {
  write("one_order.csv", "person,first,second,chosen\nP1,a,b,first\nP2,a,b,second\nP3,a,b,first\n");
  for (const char* prior : {"none", "normal"}) {
    const Ended ended = scale(std::string("one_order.csv --order-bias --prior ") + prior);
    EXPECT_EQ(ended.exit_code, 1) << ended.out;
    EXPECT_THAT(ended.out, AllOf(HasSubstr("the orders of showing do not determine the order bias"),
                                 HasSubstr("show pairs in both orders, or leave --order-bias out")));
  }
  write("pairs.csv",
        "person,first,second,chosen\nP1,a,b,first\nP2,b,a,first\nP1,c,d,first\nP2,d,c,first\nP3,a,b,first\n");
  write("ratings.csv", "person,condition,score\nP1,a,3\nP2,c,5\nP3,c,2\n");
  const Ended linked = scale("pairs.csv --ratings ratings.csv");
  EXPECT_EQ(linked.exit_code, 1) << linked.out;
  EXPECT_THAT(
      linked.out,
      AllOf(HasSubstr("no two of the rated conditions are linked by choices, so that ratings have no unit"),
            HasSubstr("ask choices between rated conditions, at least one, such as a with c")));
  const Ended same = scale("pairs.csv --ratings ./pairs.csv");
  EXPECT_EQ(same.exit_code, 1);
  EXPECT_THAT(same.out, AllOf(HasSubstr("--ratings ./pairs.csv: is the file of choices"),
                              HasSubstr("with the columns condition and score")));
  const Ended over = scale("pairs.csv --json pairs.csv");
  EXPECT_EQ(over.exit_code, 1);
  EXPECT_THAT(over.out, HasSubstr("--json pairs.csv: is the file of choices"));
}

TEST_F(ScaleCommandE2e, WithoutPeopleThereAreNoIntervalsAndAWarning) {
  const Ended ended = scale(shared + "vegetables.csv --json s.json");
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("WARNING: vegetables.csv has no column person"),
                               HasSubstr("people not known"), Not(HasSubstr("["))));
  const auto json = document_at(folder_ / "s.json");
  EXPECT_EQ(json.at("people_known"), false);
  EXPECT_EQ(json.at("warnings").size(), 1u);
  EXPECT_TRUE(json.at("observers").empty());
  for (const auto& one : json.at("scales").at(0).at("conditions"))
    EXPECT_TRUE(one.at("ci").is_null() && one.at("se").is_null() && one.at("se_sandwich").is_null());
  for (const auto& one : json.at("scales").at(0).at("differences"))
    EXPECT_TRUE(one.at("ci").is_null() && one.at("p").is_null());
}

TEST_F(ScaleCommandE2e, OnePersonIsOnePersonHoweverManyAnswers) {
  write("a.csv", "person,first,second,chosen,count\nP1,a,b,first,400\nP1,a,b,second,200\n");
  const Ended ended = scale("a.csv --reference b");
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("600 choices, 1 person"), HasSubstr("no intervals: one person"),
                               HasSubstr("a            0.64")));
}

TEST_F(ScaleCommandE2e, RatingsOfAFileJoinTheScale) {
  std::string choices = "person;first;second;chosen\n", ratings = "person,condition,score\n";
  for (int p = 0; p < 6; ++p) {
    const std::string who = "P" + std::to_string(p);
    choices +=
        who + ";a;b;" + (p % 3 ? "a" : "b") + "\n" + who + ";b;a;" + (p % 2 ? "first" : "second") + "\n";
    for (const char* what : {"a", "b", "c"})
      ratings += who + "," + what + "," +
                 std::to_string(3 + (*what == 'a') - (*what == 'c') + (p + *what) % 3) + "\n";
  }
  write("c.csv", choices);
  write("r.csv", ratings);
  const Ended ended = scale("c.csv --ratings r.csv --prior normal");
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("3 conditions, 12 choices, 18 ratings, 6 people"),
                               HasSubstr("ratings rise by")));
  // Without a column of people in one of the files nobody knows which answers are of one person.
  write("r.csv", "condition,score\na,5\na,4\nb,3\nb,4\n");
  const Ended pooled = scale("c.csv --ratings r.csv --prior normal");
  ASSERT_EQ(pooled.exit_code, 0) << pooled.out;
  EXPECT_THAT(pooled.out,
              AllOf(HasSubstr("WARNING: r.csv has no column person"), HasSubstr("people not known")));
}

TEST_F(ScaleCommandE2e, PartsThatNothingLinksAreNamed) {
  write("a.csv", "person,first,second,chosen\nP1,a,b,a\nP1,b,a,b\nP2,c,\"d, e\",c\nP2,c,\"d, e\",second\n");
  const Ended ended = scale("a.csv --json s.json");
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(
      ended.out,
      AllOf(HasSubstr("a.csv: the conditions fall into 2 parts that no answer links: {a, b} and {c, d, e}"),
            HasSubstr("such as a with c")));
  EXPECT_THAT(ended.out, Not(HasSubstr("JOD  ")));
  EXPECT_FALSE(fs::exists(folder_ / "s.json"));
}

TEST_F(ScaleCommandE2e, AConditionThatAlwaysWinsIsRefusedOrHeld) {
  write("a.csv", "person,first,second,chosen\nP1,a,b,a\nP2,b,a,a\nP3,b,c,b\nP4,c,b,c\nP5,a,c,a\n");
  const Ended refused = scale("a.csv");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.out,
              AllOf(HasSubstr("a wins every comparison with the others"), HasSubstr("--prior normal")));
  const Ended held = scale("a.csv --prior normal");
  EXPECT_EQ(held.exit_code, 0) << held.out;
  EXPECT_THAT(held.out, HasSubstr("prior: normal"));
}

TEST_F(ScaleCommandE2e, MistakesInFilesAreNamedWithTheirLine) {
  const auto refusal = [&](const std::string& text, const std::string& options = "") {
    write("a.csv", text);
    const Ended ended = scale("a.csv " + options);
    EXPECT_EQ(ended.exit_code, 1) << ended.out;
    return ended.out;
  };
  const std::string head = "person,first,second,chosen,count\n";
  EXPECT_THAT(refusal(head + "P1,a,b,x,1\n"),
              AllOf(HasSubstr("a.csv:2: has chosen \"x\""), HasSubstr("mend: write first")));
  EXPECT_THAT(refusal(head + "P1,a,b,a,1\nP1,a,a,a,1\n"), HasSubstr("a.csv:3: compares a with itself"));
  EXPECT_THAT(refusal(head + ",a,b,a,1\n"), HasSubstr("a.csv:2: has no name of one line"));
  EXPECT_THAT(refusal(head + "P1,a,b,a,-1\n"), HasSubstr("has the count \"-1\""));
  EXPECT_THAT(refusal(head + "P1,a,b,a,1.5\n"), HasSubstr("has the count \"1.5\""));
  EXPECT_THAT(refusal(head), HasSubstr("holds no answer"));
  EXPECT_THAT(refusal(head + "P1,a,b,a,0\n"), HasSubstr("holds no answer"));
  EXPECT_THAT(refusal(head + "P1,first,b,b,1\n"), HasSubstr("names a condition \"first\""));
  EXPECT_THAT(refusal("person,first,second\nP1,a,b\n"), HasSubstr("has no column chosen"));
  EXPECT_THAT(refusal(head + "P1,a,b,a,1\n", "--by first"),
              HasSubstr("--by first: is a column of the answers"));
  EXPECT_THAT(refusal(head + "P1,a,b,a,1\n", "--by scene"), HasSubstr("has no column scene"));
  EXPECT_THAT(refusal(head + "P1,a,b,a,1\nP1,a,b,b,1\n", "--reference c"),
              HasSubstr("--reference c: is no condition"));
  EXPECT_THAT(refusal(head + "P1,a,b,a,1\n", "--question x"),
              HasSubstr("--question: does not apply to a CSV file"));
  write("r.csv", "condition,score\na,nan\n");
  EXPECT_THAT(refusal(head + "P1,a,b,a,1\n", "--ratings r.csv"), HasSubstr("r.csv:2: has the score \"nan\""));
  EXPECT_THAT(scale("none.csv").out, HasSubstr("none.csv"));
}

TEST_F(ScaleCommandE2e, ChoicesAndRatingsOfADatabaseShareOneScale) {
  make_study("task1", "--participants 1 --observer random");
  const Ended alone = scale("s.db");
  EXPECT_EQ(alone.exit_code, 1);
  EXPECT_THAT(alone.out, HasSubstr("ratings alone have no scale in JOD"));

  make_study("task2", "--participants 2 --observer random");
  const Ended ended = scale("s.db --prior normal --json s.json");
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("10 conditions, 20 choices, 10 ratings, 2 people"), HasSubstr("Ours-TSp, 32k"),
                    HasSubstr("the scenes are pooled"), HasSubstr("simulated by an observer model")));
  const auto json = document_at(folder_ / "s.json");
  EXPECT_EQ(json.at("study").at("simulated"), 2);
  EXPECT_EQ(json.at("people_known"), true);
  EXPECT_EQ(fs::status(folder_ / "s.json").permissions(), fs::perms::owner_read | fs::perms::owner_write);

  const Ended choices = scale("s.db --protocol task2 --prior normal");
  EXPECT_THAT(choices.out, AllOf(HasSubstr("5 conditions, 20 choices, 2 people"), Not(HasSubstr("32k"))));
  EXPECT_THAT(scale("s.db --protocol task2 --prior normal --by scene").out,
              HasSubstr("scene faucet\n5 conditions, 10 choices, 1 person"));
  EXPECT_THAT(scale("--protocol task1 --protocol task2 --by scenes s.db").out,
              HasSubstr("the nearest is \"scene\""));
  EXPECT_THAT(scale("s.db --question mood").out, HasSubstr("--question mood: is no question"));
  EXPECT_THAT(scale("s.db --ratings r.csv").out, HasSubstr("--ratings: does not apply to a database"));
}

}  // namespace
