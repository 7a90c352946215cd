/// Each sentence of the report is tested with results for which it would be false: then it must not be
/// printed.

#include <fnmatch.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/analysis/tasks/sickness_json.hpp"
#include "libstudy/display/stimulus.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/report_blocks.hpp"
#include "tests/apps/report_sentences.hpp"
#include "tests/apps/simulated_pilot.hpp"

namespace apps {
namespace {

using report_blocks::Block;
using report_blocks::blocks_of;
using report_blocks::sentences_of;
using report_sentences::Case;
using report_sentences::cases;

/// A study with a pilot and both tasks, and something excluded of Task 1.
const study::Json& whole_study() {
  static const study::Json json = [] {
    study::PlanInForce plan;
    plan.plan.resamples = 200;
    auto task1 = made_study::task1(16);
    task1.sessions[0].trials[2].excluded = "looked away";
    auto out =
        study::make_results(
            {.protocols = {testing_pilot::simulated_pilot("ptpe:a=24,b=0.02", 12, 7), task1,
                           made_study::task2(16)},
             .withdrawn = 1,
             .about_people = made_study::about_people(16)},
            {"study.db", {study::TaskKind::Pilot, study::TaskKind::Task1, study::TaskKind::Task2}, "", plan})
            .json;
    out["sickness"] = study::sickness_json(made_study::sickness(16), plan.plan);
    return out;
  }();
  return json;
}

/// Key of a row: rows with the same key print the same sentences.
std::string kind_of(const study::Json& row) {
  std::string kind;
  for (const char* key : {"task", "score", "question", "n_star", "level"})
    if (row.contains(key)) kind += row.at(key).dump() + " ";
  return kind;
}

/// Keeps two rows of each kind in tables of more than ten, so that a page is made in milliseconds.
void shorten(study::Json& json) {
  if (json.is_array() && json.size() > 10 && json.front().is_object()) {
    std::map<std::string, int> seen;
    study::Json rows = study::Json::array();
    for (study::Json& row : json)
      if (++seen[kind_of(row)] <= 2) rows.push_back(std::move(row));
    json = std::move(rows);
  }
  if (!json.is_structured()) return;
  for (study::Json& part : json) shorten(part);
}

const study::Json& short_study() {
  static const study::Json json = [] {
    study::Json out = whole_study();
    shorten(out);
    return out;
  }();
  return json;
}

using Sentences = std::set<std::string>;

/// The sentences on the page; none if the page is refused.
Sentences sentences_on_page(const study::Json& json) {
  Sentences out;
  try {
    for (const auto& block : blocks_of(json))
      for (const auto& sentence : sentences_of(block.form)) out.insert(sentence);
  } catch (const base::Error&) {
  }
  return out;
}

/// The same, but with a cache for unchanged results: many cases change nothing before they make their
/// sentence false.
Sentences printed(const study::Json& json) {
  static const Sentences unchanged = sentences_on_page(short_study());
  return json == short_study() ? unchanged : sentences_on_page(json);
}

bool matches(const Case& one, const std::string& sentence) {
  return fnmatch(one.pattern.c_str(), sentence.c_str(), 0) == 0;
}

bool prints(const study::Json& json, const Case& one) {
  const Sentences all = printed(json);
  return std::any_of(all.begin(), all.end(), [&](const auto& sentence) { return matches(one, sentence); });
}

// So what the other tests find with the short study is true of the whole one too.
TEST(ReportSentences, TheShortStudyPrintsTheSentencesOfTheWholeOne) {
  EXPECT_EQ(sentences_on_page(short_study()), sentences_on_page(whole_study()));
}

TEST(ReportSentences, NoneIsPrintedWhereItWouldBeFalse) {
  for (const Case& one : cases()) {
    study::Json json = short_study();
    one.make_true(json);
    EXPECT_TRUE(prints(json, one)) << "never printed: " << one.pattern;
    one.make_false(json);
    EXPECT_FALSE(prints(json, one)) << "printed though false: " << one.pattern;
  }
}

TEST(ReportSentences, EverySentenceHasSuchACase) {
  Sentences all = printed(short_study());
  for (const Case& one : cases()) {
    study::Json json = short_study();
    one.make_true(json);
    all.merge(printed(json));
    one.make_false(json);
    all.merge(printed(json));
  }
  Sentences unknown;
  for (const auto& sentence : all) {
    if (sentence.find_first_not_of("#. ") == std::string::npos) continue;  // only a value of the results
    const bool known =
        std::any_of(cases().begin(), cases().end(), [&](const Case& one) { return matches(one, sentence); });
    if (!known) unknown.insert(sentence);
  }
  EXPECT_THAT(unknown, ::testing::IsEmpty());
}

/// Changes a value to another one of the same type.
void change(study::Json& value) {
  if (value.is_boolean()) {
    value = !value.get<bool>();
  } else if (value.is_number()) {
    const double number = value.get<double>();
    value = number > 0.5 && number <= 1 ? number - 0.5 : number + 2;  // p above .999 all print alike
  } else {
    value = value.get<std::string>() + " changed";
  }
}

// If a quoted value changes in the results, the sentence must change too.
TEST(ReportSentences, EveryValueQuotedIsTheResultsOwn) {
  const auto all = blocks_of(short_study());
  std::set<std::string> seen;
  for (const auto& block : all) {
    if (block.fields.empty() || !seen.insert(block.form).second) continue;
    for (const auto& field : block.fields) {
      study::Json json = short_study();
      study::Json& value = json.at(study::Json::json_pointer(field));
      if (field == "/schema" || value.is_array() || (value.is_string() && value.get<std::string>().empty()))
        continue;
      change(value);
      const auto now = blocks_of(json);
      const auto same = [&](const Block& other) { return other.words == block.words; };
      EXPECT_LT(std::count_if(now.begin(), now.end(), same), std::count_if(all.begin(), all.end(), same))
          << field << ": " << block.words;
    }
  }
  EXPECT_GT(seen.size(), 40u);
}

// "unless another share stands beside them": intervals of equivalence and of H2 and H3 hold 90 %.
TEST(ReportSentences, IntervalsOfAnotherShareSaySo) {
  std::size_t quoted = 0;
  const study::Json& json = whole_study();
  const auto page = html_reader::read(study::report::results_page(json));
  std::set<std::string> said;
  for (const auto& text : page.texts) said.insert(text.attribute("data-field"));
  for (std::size_t h = 0; h < json.at("hypotheses").size(); ++h) {
    const study::Json& tests = json.at("hypotheses")[h].at("tests");
    for (std::size_t t = 0; t < tests.size(); ++t) {
      if (tests[t].at("ci_confidence") == json.at("plan").at("confidence")) continue;
      ++quoted;
      EXPECT_TRUE(said.contains("/hypotheses/" + std::to_string(h) + "/tests/" + std::to_string(t) +
                                "/ci_confidence"));
    }
  }
  for (std::size_t c = 0; c < json.at("task1").at("comparisons").size(); ++c) {
    if (!json.at("task1").at("comparisons")[c].at("tost").contains("ci_confidence")) continue;
    ++quoted;
    EXPECT_TRUE(said.contains("/task1/comparisons/" + std::to_string(c) + "/tost/ci_confidence"));
  }
  EXPECT_GT(quoted, 20u);
}

// "Grades of evidence: A photodiode, B display feedback, C compositor, D submission by the program."
TEST(ReportSentences, GradesMeanWhatTheStoreMeans) {
  EXPECT_EQ(static_cast<char>(study::TimingGrade::Photodiode), 'A');
  EXPECT_EQ(static_cast<char>(study::TimingGrade::DisplayFeedback), 'B');
  EXPECT_EQ(static_cast<char>(study::TimingGrade::Compositor), 'C');
  EXPECT_EQ(static_cast<char>(study::TimingGrade::CpuSubmit), 'D');
}

}  // namespace
}  // namespace apps
