/// SSQ and FMS from the database to the exports.
#include "libstudy/store/read/sickness.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/export/sickness_table.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;
using ::testing::SizeIs;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

/// A lab session of Task 1 whose pages are answered one by one.
class SicknessStudy : public ::testing::Test {
 protected:
  SicknessStudy()
      : protocol_(read_protocol(base::resource("protocols/task1_lab.toml"))),
        store_(path(), sqlite::Open::Create) {
    store_.add_run(test::run_plan(protocol_, {"P01", "P02"}));
  }

  fs::path path() const { return folder_ / "study.db"; }
  OpenSession session() { return store_.open_runs().at(0).sessions.at(0); }

  /// The first open unit of a block.
  OpenUnit unit_of(const std::string& block) {
    for (const OpenUnit& unit : session().units) {
      if (protocol_.blocks.at(static_cast<std::size_t>(unit.plan.block)).id == block) return unit;
    }
    throw std::logic_error("no open unit of " + block);
  }

  /// Answers all items with the same score, but for item `left_out`, which is not answered. 0 leaves out
  /// none.
  void answer_ssq(const std::string& block, int score, int left_out = 0) {
    std::vector<KeptAnswer> kept;
    for (int item = 1; item <= stats::ssq_item_count; ++item) {
      TimedAnswer answer;
      if (item != left_out) answer.answer.score = score;
      kept.push_back({"ssq_" + std::to_string(item), answer});
    }
    const OpenUnit unit = unit_of(block);
    store_.answer(session().id, unit, 0, kept, true, 1);
  }

  void answer_fms(const std::string& block, int score) {
    const OpenUnit unit = unit_of(block);
    const int attempt = unit.trial ? test::show(store_, session(), unit, 2) : 0;
    const KeptAnswer kept{"fms", {test::score(score), 1}};
    store_.answer(session().id, unit, attempt, {&kept, 1}, true, 1);
  }

  std::vector<std::string> lines_of(const fs::path& file) const {
    std::istringstream text(test::bytes_of(file));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) {
      if (line.ends_with('\r')) line.pop_back();
      lines.push_back(line);
    }
    return lines;
  }

  test::TemporaryFolder folder_;
  Protocol protocol_;
  Store store_;
};

TEST_F(SicknessStudy, PagesKnowWhetherTheyComeBeforeTheFirstTrial) {
  answer_ssq("ssq_before", 1);
  answer_fms("sickness", 2);
  answer_fms("warm_up", 3);
  answer_fms("ratings", 5);
  answer_ssq("ssq_after", 3, 7);
  const auto sessions = read_sickness(path());
  ASSERT_THAT(sessions, SizeIs(1)) << "whoever answered neither is absent";
  const SicknessSession& read = sessions[0];
  EXPECT_EQ(read.participant, "P01");
  EXPECT_EQ(read.protocol_sha256, protocol_.sha256);
  ASSERT_THAT(read.ssq, SizeIs(2));
  ASSERT_NE(read.ssq_before(), nullptr);
  EXPECT_EQ(read.ssq_before()->block, "ssq_before");
  EXPECT_EQ(read.ssq_after()->block, "ssq_after");
  EXPECT_THAT(stats::ssq_score(stats::SsqScale::Disorientation, read.ssq_after()->answers), Optional(292.32));
  EXPECT_FALSE(stats::ssq_score(stats::SsqScale::Nausea, read.ssq_after()->answers).has_value());
  ASSERT_THAT(read.fms, SizeIs(3));
  EXPECT_FALSE(read.fms[0].trial.has_value());
  EXPECT_THAT(read.fms[1].trial, Optional(0));
  EXPECT_EQ(read.fms[2].block, "ratings");
  EXPECT_EQ(read.fms[2].score, 5);
}

TEST_F(SicknessStudy, WithoutAPageAfterwardsThereIsNone) {
  answer_ssq("ssq_before", 1);
  const auto sessions = read_sickness(path());
  EXPECT_EQ(sessions.at(0).ssq_after(), nullptr);
  EXPECT_NE(sessions.at(0).ssq_before(), nullptr);
}

TEST_F(SicknessStudy, AnAnswerAboutATrialThatIsShownAgainStillTellsHowTheyFelt) {
  answer_fms("ratings", 9);
  sqlite::Connection look(path(), sqlite::Open::Read);
  store_.repeat_trial(session().id, look.integer("SELECT trial_id FROM presentation"), "noise");
  answer_fms("ratings", 4);
  const auto sessions = read_sickness(path());
  ASSERT_THAT(sessions.at(0).fms, SizeIs(2));
  EXPECT_EQ(sessions[0].fms[0].score, 9);
  EXPECT_EQ(sessions[0].fms[0].trial, sessions[0].fms[1].trial);
}

TEST_F(SicknessStudy, AnAnswerOffItsScaleIsAnError) {
  answer_ssq("ssq_before", 1);
  {
    sqlite::Connection spoil(path(), sqlite::Open::Write);
    spoil.execute("UPDATE response SET score = 7");
  }
  EXPECT_THAT(
      [&] {
        read_sickness({path(), true});
      },  // the journal has another score
      ThrowsMessage<base::Error>(HasSubstr("answer of P01 to ssq_1: is 7, outside 0 to 3")));
}

TEST_F(SicknessStudy, CsvHoldsItemsScoresAndTheCourseWithTheirMeanings) {
  answer_ssq("ssq_before", 3);
  answer_fms("sickness", 2);
  answer_fms("warm_up", 8);
  answer_ssq("ssq_after", 3, 7);
  export_csv(path(), folder_ / "csv");
  const auto ssq = lines_of(folder_ / "csv" / "ssq.csv");
  ASSERT_THAT(ssq, SizeIs(3));
  EXPECT_THAT(ssq[0], EndsWith("ssq_16,ssq_nausea,ssq_oculomotor,ssq_disorientation,ssq_total"));
  EXPECT_THAT(ssq[1], StartsWith("1,P01,1,0,"));
  EXPECT_THAT(ssq[1], HasSubstr(",ssq_before,before,"));
  EXPECT_THAT(ssq[1], EndsWith(",3,3,200.34,159.18,292.32,235.62"));
  EXPECT_THAT(ssq[2], HasSubstr(",ssq_after,after,"));
  EXPECT_THAT(ssq[2], EndsWith(",3,3,,159.18,292.32,"));
  EXPECT_THAT(lines_of(folder_ / "csv" / "fms.csv"), SizeIs(3));
  const auto summary = lines_of(folder_ / "csv" / "fms_summary.csv");
  ASSERT_THAT(summary, SizeIs(4));
  EXPECT_THAT(summary[1], EndsWith(",,2,5,8"));
  EXPECT_THAT(summary[2], EndsWith(",sickness,1,2,2"));
  EXPECT_THAT(summary[3], EndsWith(",warm_up,1,8,8"));
  const std::string dictionary = test::bytes_of(folder_ / "csv" / "dictionary.csv");
  for (const SicknessTable& table : sickness_tables({})) {
    for (const SicknessColumn& column : table.columns)
      EXPECT_THAT(dictionary,
                  HasSubstr("\r\n" + table.name + ".csv," + column.name + "," + column.type + ","));
  }
  export_csv(path(), folder_ / "csv");  // an earlier export with these files is recognised
}

TEST_F(SicknessStudy, BidsHasTheScoresBesideTheItems) {
  answer_ssq("ssq_before", 3, 16);
  answer_fms("sickness", 2);
  const KeptAnswer sharing{sharing_question, {test::score(1), 1}};
  const OpenUnit consent = unit_of("consent");
  store_.answer(session().id, consent, 0, {&sharing, 1}, true, 1);
  export_bids(path(), folder_ / "bids");
  const auto ssq = lines_of(folder_ / "bids" / "phenotype" / "ssq.tsv");
  ASSERT_THAT(ssq, SizeIs(2));
  EXPECT_THAT(ssq[0], EndsWith("before_ssq_oculomotor\ttask1labv1_ssq_before_ssq_disorientation\t"
                               "task1labv1_ssq_before_ssq_total"));
  EXPECT_THAT(ssq[1], EndsWith("\tn/a\tn/a\t159.18\t292.32\tn/a"));
  const auto meaning = base::Json::parse(test::bytes_of(folder_ / "bids" / "phenotype" / "ssq.json"));
  EXPECT_THAT(meaning["task1labv1_ssq_before_ssq_total"]["Description"].get<std::string>(),
              HasSubstr("3.74 times"));
  const auto fms = lines_of(folder_ / "bids" / "phenotype" / "fmssummary.tsv");
  EXPECT_THAT(fms,
              ElementsAre("participant_id\ttask1labv1_fms_answers\ttask1labv1_fms_mean\ttask1labv1_fms_peak\t"
                          "task1labv1_sickness_fms_answers\ttask1labv1_sickness_fms_mean\t"
                          "task1labv1_sickness_fms_peak",
                          "sub-P01\t1\t2\t2\t1\t2\t2"));
}

TEST_F(SicknessStudy, PsychDsHasAFileForEachAndDescribesEveryColumn) {
  answer_ssq("ssq_before", 3);
  const KeptAnswer sharing{sharing_question, {test::score(1), 1}};
  const OpenUnit consent = unit_of("consent");
  store_.answer(session().id, consent, 0, {&sharing, 1}, true, 1);
  export_psych_ds(path(), folder_ / "pds");
  const fs::path data = folder_ / "pds" / "data";
  const std::string stem = "study-task1lab_subject-P01_session-task1labv1_description-";
  const auto ssq = lines_of(data / (stem + "ssq_data.csv"));
  ASSERT_THAT(ssq, SizeIs(2));
  EXPECT_THAT(ssq[1], EndsWith(",200.34,159.18,292.32,235.62"));
  EXPECT_FALSE(fs::exists(data / (stem + "fms_data.csv"))) << "FMS was not answered";
  const auto json = base::Json::parse(test::bytes_of(folder_ / "pds" / "dataset_description.json"));
  std::set<std::string> described;
  for (const auto& variable : json["variableMeasured"]) described.insert(variable["name"].get<std::string>());
  std::istringstream header(ssq[0]);
  for (std::string name; std::getline(header, name, ',');) EXPECT_TRUE(described.contains(name)) << name;
}

TEST(Sickness, StudiesThatAskForNeitherHaveNone) {
  const test::TemporaryFolder folder;
  Store(folder / "study.db", sqlite::Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
  EXPECT_THAT(read_sickness(folder / "study.db"), IsEmpty());
}

}  // namespace
}  // namespace study
