/// Each sentence of the report's page rests on a fact of the results, and is not printed where the fact does
/// not hold.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "libstudy/display/stimulus.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/report_blocks.hpp"
#include "tests/apps/report_task_facts.hpp"

namespace apps {
namespace {

using report_facts::Fact;

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

using Sentences = std::set<std::string>;

/// The sentences of the page and their clauses, with "#" for each value.
Sentences sentences_of(const study::Json& json) {
  Sentences out;
  for (const auto& block : report_blocks::blocks_of(json)) {
    for (std::string rest : report_blocks::sentences_of(block.form)) {
      for (auto at = rest.find("= #"); at != std::string::npos; at = rest.find("= #")) rest.erase(at, 2);
      if (rest.find_first_not_of("#. ") == std::string::npos) continue;
      const bool clauses = rest.find("; ") != std::string::npos;
      if (clauses && rest.ends_with('.')) rest.pop_back();
      for (auto end = rest.find("; "); end != std::string::npos; end = rest.find("; ")) {
        out.insert(rest.substr(0, end));
        rest.erase(0, end + 2);
      }
      out.insert(rest);
    }
  }
  return out;
}

/// The sentence up to a list in it, without the names of parts, which are not the same in all results.
std::string kind_of(const std::string& sentence) {
  static const std::regex parts("(Pilot|Task [12])((, | and )(Pilot|Task [12]))*");
  return std::regex_replace(sentence.substr(0, sentence.find(": ")), parts, "#");
}

std::string lines_of(const Sentences& sentences) {
  std::string out;
  for (const auto& one : sentences) out += "\n  " + one;
  return out;
}

TEST(ReportSentences, EachStandsWhereItsFactHoldsAlone) {
  auto task1 = made_study::task1(16);
  task1.sessions[0].trials[2].excluded = "looked away";
  study::Json json = made_study::whole_study(16, task1);
  const Sentences whole = sentences_of(json);
  shorten(json);
  ASSERT_EQ(sentences_of(json), whole) << "what is true of the short study is true of the whole one";
  Sentences resting, kinds, printed, after;
  const auto rests = [&](const std::string& one) {
    resting.insert(one);
    kinds.insert(kind_of(one));
  };
  const Sentences always = sentences_of({{"schema", "vip-results/1"}});
  EXPECT_EQ(always.size(), 3u) << "where the numbers come from" << lines_of(always);
  for (const auto& one : always) rests(one);
  for (const Fact& fact : report_facts::facts()) {
    study::Json with = json;
    fact.begins(with);
    study::Json without = with;
    fact.ends(without);
    const Sentences held = with == json ? whole : sentences_of(with), ended = sentences_of(without);
    Sentences gone;
    std::set_difference(held.begin(), held.end(), ended.begin(), ended.end(),
                        std::inserter(gone, gone.end()));
    const std::string lines = lines_of(gone);
    EXPECT_EQ(static_cast<int>(gone.size()), fact.sentences) << fact.word << ":" << lines;
    EXPECT_NE(lines.find(fact.word), std::string::npos) << fact.word << ":" << lines;
    for (const auto& one : gone) rests(one);
    printed.insert(held.begin(), held.end());
    after.insert(ended.begin(), ended.end());
  }
  std::erase_if(printed, [&](const auto& one) { return resting.contains(one); });
  std::erase_if(after, [&](const auto& one) { return kinds.contains(kind_of(one)); });
  EXPECT_EQ(lines_of(printed) + lines_of(after), "") << "sentences that rest on no fact";
}

// The report explains the grades by their letters, A to D, as the database stores them.
TEST(ReportSentences, GradesMeanWhatTheStoreMeans) {
  EXPECT_EQ(static_cast<char>(study::TimingGrade::Photodiode), 'A');
  EXPECT_EQ(static_cast<char>(study::TimingGrade::DisplayFeedback), 'B');
  EXPECT_EQ(static_cast<char>(study::TimingGrade::Compositor), 'C');
  EXPECT_EQ(static_cast<char>(study::TimingGrade::CpuSubmit), 'D');
}

}  // namespace
}  // namespace apps
