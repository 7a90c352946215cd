/// The report's description of a study: people, distributions, lines, reliability, detectable effects, times;
/// and the layout of its page.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libstudy/analysis/tasks/people_json.hpp"
#include "libstudy/report/page.hpp"
#include "stats/base/json.hpp"
#include "stats/inference/t_test.hpp"
#include "tests/apps/html_reader.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/report_blocks.hpp"

namespace apps {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::Pair;

constexpr int people = 26;

const study::Json& made() {
  static const study::Json json = made_study::whole_study(people, made_study::task1(people));
  return json;
}

const std::string& page() {
  static const std::string html = study::report::results_page(made());
  return html;
}

TEST(PeopleOfTheReport, SmallGroupsAreTakenTogetherWithTheNextSmallest) {
  const auto groups = [](std::vector<std::pair<std::string, int>> counts) {
    return study::pool_small_groups(std::move(counts));
  };
  auto got = groups({{"f", 13}, {"m", 12}, {"another", 1}});
  EXPECT_THAT(got.shown, ElementsAre(Pair("f", 13)));
  EXPECT_THAT(got.pooled, ElementsAre("another", "m"));
  EXPECT_EQ(got.pooled_people, 13) << "else the group of one follows from the sum";
  got = groups({{"f", 13}, {"m", 12}, {"another", 0}});
  EXPECT_THAT(got.shown, ElementsAre(Pair("f", 13), Pair("m", 12)));
  EXPECT_THAT(got.pooled, IsEmpty());
  got = groups({{"f", 9}, {"m", 4}, {"another", 2}, {"none", 1}});
  EXPECT_THAT(got.shown, ElementsAre(Pair("f", 9), Pair("m", 4)));
  EXPECT_EQ(got.pooled_people, 3);
  EXPECT_THAT(groups({{"f", 1}, {"m", 1}}).shown, IsEmpty());
}

// For all counts of three answers: each group that is shown, and the pool of all others beside shown ones,
// which follows from the sum, has at least smallest_group people.
TEST(PeopleOfTheReport, NoGroupThatIsShownOrFollowsIsSmaller) {
  for (int f = 0; f <= 9; ++f) {
    for (int m = 0; m <= 9; ++m) {
      for (int other = 0; other <= 5; ++other) {
        const auto got = study::pool_small_groups({{"f", f}, {"m", m}, {"other", other}});
        int shown = 0;
        for (const auto& [answer, n] : got.shown) {
          EXPECT_GE(n, study::smallest_group);
          shown += n;
        }
        EXPECT_EQ(shown + got.pooled_people, f + m + other);
        if (!got.pooled.empty() && !got.shown.empty()) {
          EXPECT_GE(got.pooled_people, study::smallest_group);
        }
      }
    }
  }
}

TEST(PeopleOfTheReport, AgeAndGenderOfThoseAnalysedStandInSummary) {
  const study::Json& task1 = made().at("people").at(0);  // the pilot asks nothing
  EXPECT_EQ(task1.at("task"), "task1");
  EXPECT_EQ(task1.at("participants"), people);
  const study::Json &age = task1.at("questions").at(0), &gender = task1.at("questions").at(1);
  EXPECT_EQ(age.at("n"), 25);
  EXPECT_EQ(age.at("missing"), 1);
  double sum = 0, squares = 0;
  for (int person = 0; person < 25; ++person) sum += 20 + person % 12;
  for (int person = 0; person < 25; ++person) squares += std::pow(20 + person % 12 - sum / 25, 2);
  EXPECT_NEAR(age.at("mean"), sum / 25, 1e-12);
  EXPECT_NEAR(age.at("sd"), std::sqrt(squares / 24), 1e-12);
  EXPECT_EQ(age.at("range"), study::Json({20, 35})) << "20 to 31, in whole fives: the ends are single people";
  EXPECT_EQ(gender.at("groups"), study::Json::array({{{"answer", "male"}, {"n", 12}}}));
  EXPECT_EQ(gender.at("pooled").at("n"), 13);
  const auto few = made_study::results_of(
                       {.protocols = {made_study::task1(4)}, .about_people = made_study::about_people(4)})
                       .at("people")
                       .at(0)
                       .at("questions");
  EXPECT_FALSE(few.at(0).contains("mean"));
  EXPECT_THAT(few.at(0).at("refused").get<std::string>(), HasSubstr("fewer than 5"));
  EXPECT_THAT(few.at(1).at("groups"), IsEmpty());
}

TEST(DescriptionOfTheReport, DistributionsCountEveryAnswer) {
  const auto study = made_study::task1(people);
  std::map<std::string, int> wanted;  // counts of realism at 16k, by "method score"
  for (const auto& session : study.sessions)
    for (const auto& trial : session.trials)
      if (trial.first.what.n_star == "16k")
        ++wanted[trial.first.what.method + " " + std::to_string(*trial.answers.at(0).score)];
  int seen = 0, all = 0;
  for (const study::Json& cell : made().at("task1").at("distributions")) {
    int n = 0;
    for (const study::Json& one : cell.at("counts")) {
      n += one.at("n").get<int>();
      if (cell.at("question") != "realism" || cell.at("n_star") != "16k") continue;
      const auto key = cell.at("method").get<std::string>() + " " + one.at("score").dump();
      EXPECT_EQ(one.at("n"), wanted[key]) << key;
      ++seen;
    }
    EXPECT_EQ(n, cell.at("n"));
    all += n;
  }
  EXPECT_EQ(seen, 5 * 7);
  EXPECT_EQ(all, people * 10 * 5);
  int ratings = 0;
  for (const study::Json& cell : made().at("pilot").at("distributions")) ratings += cell.at("n").get<int>();
  EXPECT_EQ(ratings, 16 * 21);
}

TEST(DescriptionOfTheReport, MethodsByNStarAreDifferencesOfDifferences) {
  std::map<std::string, std::map<std::string, double>> scores;  // by participant, then n_star and method
  for (const study::Json& mean : made().at("task1").at("participant_means"))
    scores[mean.at("participant")]
          [mean.at("n_star").get<std::string>() + mean.at("method").get<std::string>()] = mean.at("realism");
  std::vector<double> differences;
  for (auto& [person, of] : scores)
    differences.push_back((of["16kLoRes"] - of["16kOurs"]) - (of["32kLoRes"] - of["32kOurs"]));
  const auto wanted = stats::t_test_one(differences);
  int found = 0;
  for (const study::Json& one : made().at("task1").at("by_n_star")) {
    EXPECT_GE(one.at("p_holm").get<double>(), one.at("p").get<double>());
    if (one.at("score") != "realism" || one.at("a") != "LoRes" || one.at("b") != "Ours") continue;
    EXPECT_NEAR(one.at("difference"), wanted->estimate, 1e-12);
    EXPECT_NEAR(one.at("p"), wanted->p, 1e-12);
    ++found;
  }
  EXPECT_EQ(found, 1);
}

TEST(DescriptionOfTheReport, ReliabilityDetectableEffectsAndTimesAreGiven) {
  const study::Json& task1 = made().at("task1");
  ASSERT_EQ(task1.at("reliability").size(), 4u) << "four items and three, at two n_*";
  for (const study::Json& one : task1.at("reliability")) {
    EXPECT_LT(one.at("ci")[0], one.at("alpha"));
    EXPECT_GT(one.at("ci")[1], one.at("alpha"));
    EXPECT_EQ(one.at("n"), people);
  }
  for (const study::Json& one : task1.at("detectable")) {
    EXPECT_NEAR(one.at("d_z"), 0.571704834713, 1e-9) << "R's power.t.test for 26";
    EXPECT_NEAR(one.at("points").get<double>(),
                one.at("d_z").get<double>() * one.at("sd_difference").get<double>(), 1e-12);
  }
  EXPECT_NEAR(made().at("task2").at("detectable").at("share"), 0.778848249382, 1e-9);
  const study::Json& times = made().at("response_times");
  ASSERT_EQ(times.size(), 5u) << "the questions of Task 1; the others have no times";
  EXPECT_EQ(times[0].at("n"), people * 10);
  EXPECT_DOUBLE_EQ(times[0].at("min").get<double>(), 1.5);
  EXPECT_DOUBLE_EQ(times[0].at("max").get<double>(), 1.5 + 0.75 + 0.9);
}

TEST(DescriptionOfTheReport, EachPictureOfTask1HasEveryMethodAndPerson) {
  const auto has = [](const std::string& id) {
    return page().find("id=\"" + id + "-title\"") != std::string::npos;
  };
  for (const char* score : {"realism", "sickness"}) {
    EXPECT_TRUE(has(std::string("person-lines-") + score));
    EXPECT_TRUE(has(std::string("scene-lines-") + score));
  }
  for (const char* question : {"realism", "disorientation", "unrealism", "dizziness", "confusion", "pilot"})
    EXPECT_TRUE(has(std::string("ratings-") + question)) << question;
  const auto from = page().find("id=\"person-lines-realism-title\"");
  const auto picture = page().substr(from, page().find("</svg>", from) - from);
  std::size_t lines = 0;
  for (auto at = picture.find("stroke-opacity"); at != std::string::npos;
       at = picture.find("stroke-opacity", at + 1))
    ++lines;
  EXPECT_EQ(lines, 2u * people) << "one for each participant at each n_*";
}

// Names of methods with a level of effects are long; nothing may be drawn beyond the picture's edges.
TEST(PageOfTheReport, PicturesHaveRoomForLongNames) {
  const std::string name = "LoRes, rather_long_name_of_foam_and_spray";
  study::Json json = made();
  for (study::Json& pair : json.at("task2").at("pairs")) pair["a"] = pair["b"] = name;
  for (study::Json& one : json.at("task1").at("distributions")) one["method"] = name;
  const auto html = study::report::results_page(json);
  const auto room = [&](const std::string& id, const std::string& mark) {
    const auto at = html.find(mark, html.find("id=\"" + id + "-title\""));
    return std::stod(html.substr(at + mark.size()));
  };
  const double needed = 6.5 * static_cast<double>(name.size());
  EXPECT_GT(room("preference", "translate(") + 110, needed);
  EXPECT_GT(room("ratings-realism", "translate(") + 182, needed);
  const auto box = html.rfind("viewBox=\"0 0 ", html.find("id=\"preference-title\""));
  EXPECT_GT(std::stod(html.substr(box + 13)) - room("preference", "translate(") - 606, needed);
}

// In an earlier version the solver's row had the interval of the direct estimate, while the sentence above it
// had the wider interval that is for the solver.
TEST(PageOfTheReport, TheSolversRowHasTheSolversInterval) {
  const auto from = page().find("For the solver</strong>");
  ASSERT_NE(from, std::string::npos);
  const auto row = page().substr(from, page().find("</tr>", from) - from);
  for (const char* field :
       {"/pilot/a\"", "/pilot/a_ci/0", "/pilot/a_ci/1", "/pilot/b\"", "/pilot/b_ci/0", "/pilot/b_ci/1"})
    EXPECT_THAT(row, HasSubstr(field));
  EXPECT_THAT(page(), Not(HasSubstr("(for the solver)")));
}

TEST(PageOfTheReport, EveryPairHasTheIntervalOfItsLocationOrAReason) {
  for (const study::Json& pair : made().at("task1").at("comparisons")) {
    const study::Json& ranks = pair.at("wilcoxon");
    EXPECT_EQ(ranks.at("p"), ranks.at("p_exact"));
    EXPECT_EQ(ranks.at("method"), "exact");
    EXPECT_EQ(ranks.at("ci").size(), 2u);
    EXPECT_EQ(ranks.at("ci_reason"), "");
  }
  for (const study::Json& all : made().at("task1").at("omnibus")) {
    EXPECT_LE(all.at("anova").at("epsilon_hf"), 1);
    EXPECT_GE(all.at("anova").at("epsilon_hf_uncapped"), all.at("anova").at("epsilon_hf"));
  }
}

TEST(PageOfTheReport, SentencesBeginWithACapital) {
  for (const auto& block : report_blocks::blocks_of(made())) {
    for (const auto& sentence : report_blocks::sentences_of(block.words)) {
      const auto first = sentence.find_first_not_of(" ");
      if (first == std::string::npos || sentence.size() < 12) continue;
      EXPECT_FALSE(std::islower(static_cast<unsigned char>(sentence[first])))
          << sentence << "\nof " << block.words;
    }
  }
}

TEST(PageOfTheReport, FormulasAreSet) {
  for (const auto& text : html_reader::read(page()).texts) {
    if (text.within("style")) continue;
    for (const char* typed : {"n_*", "mu(", "^2", "exp(", "+-", " delta", "p_Holm"})
      EXPECT_THAT(text.words, Not(HasSubstr(typed)));
  }
  EXPECT_THAT(page(), HasSubstr("<i>n</i><sub>*</sub>"));
  EXPECT_THAT(page(), HasSubstr("e<sup><i>b</i>"));
}

TEST(PageOfTheReport, TimingComesAfterTheResultsAndShowsFailuresAlone) {
  EXPECT_GT(page().find("id=\"timing\""), page().find("id=\"hypotheses\""));
  EXPECT_THAT(page(), Not(HasSubstr("id=\"timing-task1-title\""))) << "every showing passed";
  auto study = made_study::task1(6);
  study.sessions[2].trials[3].first.verdict = study::Verdict::Fail;
  const study::Json json = made_study::results_of({{study}, 0});
  EXPECT_EQ(json.at("timing_totals").at(0).at("fail"), 1);
  EXPECT_EQ(json.at("timing_totals").at(0).at("flawed_cells"), 1);
  const auto html = study::report::results_page(json);
  const auto from = html.find("cells in which a showing was degraded or failed</caption>");
  ASSERT_NE(from, std::string::npos);
  const auto table = html.substr(from, html.find("</table>", from) - from);
  std::size_t rows = 0;
  for (auto at = table.find("<tr>"); at != std::string::npos; at = table.find("<tr>", at + 1)) ++rows;
  EXPECT_EQ(rows, 2u) << "the heading and the cell that failed";
  EXPECT_THAT(html, HasSubstr("id=\"timing-task1-title\""));
}

}  // namespace
}  // namespace apps
