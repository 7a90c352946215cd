/// One rule decides which answers and showings count (schema step 4); all readers and writers follow it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "tests/common/tables.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Open;
using ::test::NamedRows;

/// Positions of the trials of a lab session of Task 1, the practice first.
enum Trials { practice, plain, unanswered, set_aside, repeated, excluded, cut, again, parted };

/// A session in which each of these trials has the history that its name gives. The reason of a showing's
/// verdict is "attempt N".
class Counting : public ::testing::Test {
 protected:
  Counting() {
    const Protocol protocol = read_protocol(base::resource("protocols/task1_lab.toml"));
    store_.add_run(test::run_plan(protocol, {"P01"}));
    for (const OpenUnit& page : session().units) {
      if (protocol.blocks.at(static_cast<std::size_t>(page.plan.block)).kind != BlockKind::Consent) continue;
      const KeptAnswer shared{"data_shared", {test::score(1), 1}};
      store_.answer(session().id, page, 0, {&shared, 1}, false, 900);
    }
    for (const Trials trial : {practice, plain, set_aside, repeated, excluded}) judge(trial, 1, 3, true);
    show(unanswered, 1);
    for (const Trials trial : {set_aside, repeated})
      store_.repeat_trial(session().id, trial_ids_.at(trial), "");
    judge(repeated, 2, 6, true);
    store_.exclude_trial(session().id, trial_ids_.at(excluded), "sneezed");
    begin(cut, 1);
    show(again, 1);
    judge(again, 2, 5, true);
    judge(parted, 1, 4, false);
    show(parted, 2);
    keep(parted, 2, {{"fms", 7}}, true);
    store_.open_runs();  // marks the unfinished presentation as interrupted
  }

  OpenSession session() { return store_.open_runs().at(0).sessions.at(0); }
  const OpenUnit& unit(int position) {
    for (const OpenUnit& one : units_.emplace_back(session().units)) {
      if (one.trial && one.trial->position == position) {
        trial_ids_[position] = one.trial_id;
        return one;
      }
    }
    throw std::logic_error("the trial is done");
  }
  std::int64_t begin(int position, int attempt) {
    const OpenUnit& one = unit(position);
    return store_.begin_presentation(session().id, one.trial_id, attempt, 0, one.trial->first, 0);
  }
  void show(int position, int attempt) {
    TimingVerdict verdict = test::verdict();
    verdict.reason = "attempt " + std::to_string(attempt);
    store_.end_presentation(begin(position, attempt), 0, 1, test::frames(0, 2), verdict);
  }
  void keep(int position, int attempt, const std::vector<std::pair<std::string, int>>& page, bool last) {
    std::vector<KeptAnswer> answers;
    for (const auto& [question, score] : page) answers.push_back({question, {test::score(score), 1}});
    store_.answer(session().id, unit(position), attempt, answers, last, 900);
  }
  /// Shows the trial and answers all questions, or all but the last one.
  void judge(int position, int attempt, int realism, bool whole) {
    show(position, attempt);
    std::vector<std::pair<std::string, int>> page{
        {"realism", realism}, {"disorientation", 0}, {"unrealism", 1}, {"dizziness", 2}, {"confusion", 3}};
    if (whole) page.emplace_back("fms", 0);
    keep(position, attempt, page, whole);
  }

  const test::TemporaryFolder folder_;
  const fs::path path_ = folder_ / "study.db";
  Store store_{path_, Open::Create};
  std::vector<std::vector<OpenUnit>> units_;
  std::map<int, std::int64_t> trial_ids_;
};

/// By trial and attempt: why the showing does not count; empty if it counts.
const std::map<std::pair<int, int>, std::string> expected{{{practice, 1}, "practice"},
                                                          {{plain, 1}, ""},
                                                          {{unanswered, 1}, "not answered"},
                                                          {{set_aside, 1}, "set aside"},
                                                          {{repeated, 1}, "set aside"},
                                                          {{repeated, 2}, ""},
                                                          {{excluded, 1}, "excluded"},
                                                          {{cut, 1}, "cut short"},
                                                          {{again, 1}, "shown again"},
                                                          {{again, 2}, ""},
                                                          {{parted, 1}, ""},
                                                          {{parted, 2}, ""}};

TEST_F(Counting, EachTrialIsKnownByTheShowingThatWasJudgedFirst) {
  const auto trials = read_tasks(path_).protocols.at(0).sessions.at(0).trials;
  const auto reason = [&](int position) {
    return trials.at(static_cast<std::size_t>(position)).first.reason;
  };
  const auto realism = [&](int position) {
    return trials.at(static_cast<std::size_t>(position)).answers.at(0).score;
  };
  EXPECT_EQ(realism(plain), 3);
  EXPECT_FALSE(realism(unanswered));
  EXPECT_EQ(reason(unanswered), "attempt 1");
  EXPECT_FALSE(realism(set_aside));
  EXPECT_FALSE(trials.at(set_aside).first.verdict) << "set aside, so nothing of it is known";
  EXPECT_EQ(realism(repeated), 6);
  EXPECT_EQ(reason(repeated), "attempt 2");
  EXPECT_EQ(trials.at(excluded).excluded, "sneezed");
  EXPECT_FALSE(trials.at(plain).excluded);
  EXPECT_FALSE(trials.at(cut).first.played);
  EXPECT_EQ(reason(again), "attempt 2");
  EXPECT_EQ(reason(parted), "attempt 1");
  EXPECT_EQ(trials.at(parted).answers.at(5).score, 7) << "given after the second";
}

TEST_F(Counting, TheCertificateIsOfJudgedShowingsAlone) {
  std::int64_t trials = 0;
  for (const CertificateRow& row : read_certificate(path_, 1, FpsMean::Harmonic)) trials += row.trials;
  // Counted are one showing each of practice, plain, repeated, excluded and again, and both showings of
  // parted.
  EXPECT_EQ(trials, 7);
}

// A pilot of 40 people has about 280,000 frames, so the means of a showing must be computed from an index
// search for its own frames, not from a scan of the table of all frames.
TEST_F(Counting, AShowingsMeansAreReadFromItsOwnFramesAlone) {
  sqlite::Connection database(path_, Open::Read);
  sqlite::Statement plan(database,
                         "EXPLAIN QUERY PLAN SELECT (SELECT tau_fps FROM solving v "
                         "WHERE v.presentation_id = presentation.presentation_id) FROM presentation");
  std::string steps;
  while (plan.step()) steps += plan.text(3) + "\n";
  EXPECT_THAT(steps, testing::HasSubstr("SEARCH f USING PRIMARY KEY (presentation_id=?)"));
  EXPECT_THAT(steps, testing::Not(testing::HasSubstr("SCAN f\n")));
}

TEST_F(Counting, EveryExportSaysOfEachShowingWhetherItCounts) {
  export_csv(path_, folder_ / "csv");
  export_bids(path_, folder_ / "bids");
  std::map<std::string, std::pair<int, int>> shown;
  sqlite::Connection look(path_, Open::Read);
  sqlite::Statement row(
      look, "SELECT presentation_id, position, attempt FROM presentation JOIN trial USING (trial_id)");
  while (row.step()) shown[row.text(0)] = {row.integer(1), row.integer(2)};
  NamedRows presentations = ::test::read_csv(folder_ / "csv/presentations.csv");
  ASSERT_EQ(presentations.size(), expected.size());
  for (auto& line : presentations) {
    SCOPED_TRACE(line["presentation_id"]);
    EXPECT_EQ(line["why_not"], expected.at(shown.at(line["presentation_id"])));
    EXPECT_EQ(line["counts"], line["why_not"].empty() ? "1" : "0");
  }
  fs::path events;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "bids")) {
    if (entry.path().string().ends_with("_events.tsv")) events = entry.path();
  }
  NamedRows lines = ::test::read_tsv(events);
  ASSERT_EQ(lines.size(), expected.size());
  for (auto& line : lines) {
    const std::string& why = expected.at({std::stoi(line["trial"]), std::stoi(line["attempt"])});
    EXPECT_EQ(line["why_not"], why.empty() ? "n/a" : why);
    EXPECT_EQ(line["counts"], why.empty() ? "1" : "0");
    // Interrupted showings have no frames.
    EXPECT_EQ(line["active_fraction"], line["state"] == "played" ? "0.75" : "n/a");
    EXPECT_EQ(line["tau_fps"], line["state"] == "played" ? "-2.5" : "n/a");
  }
}

TEST_F(Counting, EveryExportSaysOfEachAnswerWhetherItCounts) {
  export_csv(path_, folder_ / "csv");
  export_psych_ds(path_, folder_ / "psych");
  NamedRows responses = ::test::read_csv(folder_ / "csv/responses.csv");
  std::map<std::string, int> reasons;
  for (auto& line : responses) ++reasons[line["why_not"] + " " + line["counts"]];
  // Six questions a trial, and one on a page.
  EXPECT_EQ(reasons, (std::map<std::string, int>{
                         {" 1", 25}, {"excluded 0", 6}, {"practice 0", 6}, {"set aside 0", 12}}));
  std::vector<fs::path> tables{folder_ / "csv/ratings.csv"};
  for (const auto& entry : fs::directory_iterator(folder_ / "psych/data")) {
    if (entry.path().string().find("_description-") == std::string::npos) tables.push_back(entry.path());
  }
  ASSERT_EQ(tables.size(), 2u);
  const std::map<std::string, std::string> of_trial{{"0", "practice"},     {"1", ""}, {"2", "not answered"},
                                                    {"3", "not answered"}, {"4", ""}, {"5", "excluded"},
                                                    {"6", "not answered"}, {"7", ""}, {"8", ""},
                                                    {"9", "not answered"}};
  for (const fs::path& table : tables) {
    for (auto& line : ::test::read_csv(table)) {
      if (!of_trial.contains(line["position"])) continue;
      EXPECT_EQ(line["why_not"], of_trial.at(line["position"])) << table << line["position"];
      EXPECT_EQ(line["counts"], line["why_not"].empty() ? "1" : "0");
      EXPECT_EQ(line["attempt"].empty(), line["first_verdict"].empty());
    }
  }
}

}  // namespace
}  // namespace study
