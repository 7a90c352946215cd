/// The report of studies that are not one protocol of each of the paper's tasks: other designs, several
/// versions of a protocol, several questions.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/tasks/csv.hpp"
#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/report/page.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/report_blocks.hpp"
#include "tests/apps/report_walk.hpp"
#include "tests/apps/simulated_pilot.hpp"

namespace apps {
namespace {

using made_study::results_of;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

study::TaskProtocol of_two_methods(const std::string& name, char digit, bool pairs, int people) {
  return {name, "1.0", std::string(64, digit), pairs, people, made_study::scenes, {"LoRes", "HiRes"}, {"1k"},
          {},   {}};
}

/// Two methods in three scenes, each rated on two scales of 1 to 4.
study::TaskProtocol comfort(int participants) {
  auto out = of_two_methods("comfort", '4', false, participants);
  out.questions = {made_study::scale("comfort", 1, 4), made_study::scale("strain", 1, 4)};
  out.questions[0].text = "How comfortable was it, of 4?";
  for (int person = 0; person < participants; ++person) {
    auto visit = made_study::session(made_study::code(person), "none");
    visit.observer = "random";
    for (int position = 0; position < 6; ++position) {
      study::TaskTrial trial;
      trial.position = position;
      trial.kind = "stimulus";
      trial.first = made_study::showing(made_study::scenes[static_cast<std::size_t>(position / 2)],
                                        position % 2 ? "HiRes" : "LoRes", "1k");
      trial.answers = {{"comfort", position % 2 ? 3 : 1 + person % 2}, {"strain", 2}};
      visit.trials.push_back(trial);
    }
    out.sessions.push_back(visit);
  }
  return out;
}

study::TaskProtocol mended(study::TaskProtocol protocol, char digit) {
  protocol.version = "1.1";
  protocol.sha256 = std::string(64, digit);
  return protocol;
}

/// The pilot with a second question, smoothness, on a scale of 0 to 3.
study::TaskProtocol pilot_of_two_questions() {
  auto out = testing_pilot::simulated_pilot("ptpe:a=24,b=0.02", 8, 7);
  out.questions.push_back(made_study::scale("smoothness", 0, 3));
  for (auto& session : out.sessions) {
    session.observer.clear();
    for (auto& trial : session.trials)
      trial.answers.push_back({"smoothness", (*trial.answers[0].score - 1) / 2});
  }
  return out;
}

/// Checks that everything is on one page, each number is in the JSON, and each session is in a flow of
/// participants.
void expect_true_page(const study::Json& json) {
  const auto page = html_reader::read(study::report::results_page(json));
  EXPECT_THAT(report_walk::wrong_fields(page, json), IsEmpty());
  EXPECT_THAT(report_walk::unmarked_numbers(page, json), IsEmpty());
  EXPECT_EQ(report_walk::sessions_in_flows(json), json.at("roster").at("sessions"));
  EXPECT_THAT(report_walk::wrong_references(page), IsEmpty());
}

TEST(ReportChoice, AnotherDesignHasFlowTimingAndAnswersByCell) {
  const study::Json json = results_of({{comfort(12)}, 0});
  expect_true_page(json);
  EXPECT_EQ(json.at("flow").at("own").at("analysed"), 12);
  EXPECT_EQ(json.at("timing").size(), 6u);
  ASSERT_EQ(json.at("descriptives").size(), 2u);
  const study::Json& cell = json.at("descriptives")[0].at("cells").at(0);
  EXPECT_EQ(cell.at("shown"), "LoRes");
  EXPECT_EQ(cell.at("n"), 12);
  EXPECT_EQ(cell.at("mean"), 1.5);
  EXPECT_NEAR(cell.at("sd").get<double>(), std::sqrt(3.0 / 11), 1e-12);
  EXPECT_EQ(cell.at("median"), 1.5);
  EXPECT_EQ(cell.at("distribution"), (study::Json{{{"answer", 1}, {"count", 6}},
                                                  {{"answer", 2}, {"count", 6}},
                                                  {{"answer", 3}, {"count", 0}},
                                                  {{"answer", 4}, {"count", 0}}}));
  EXPECT_TRUE(json.at("hypotheses").empty());
  EXPECT_THAT(json.at("not_analysed").at(0).at("reason").get<std::string>(), HasSubstr("realism"));
  const std::string html = study::report::results_page(json);
  for (const char* words : {"Simulated participants", "Flow of participants", "Timing certificate",
                            "Answers by cell", "Not analysed"})
    EXPECT_NE(html.find(words), std::string::npos) << words;
}

TEST(ReportChoice, TwoVersionsOfATaskStandApart) {
  const study::Json json = results_of({{mended(made_study::task1(3), '5'), made_study::task1(12)}, 2});
  expect_true_page(json);
  EXPECT_EQ(json.at("flow").at("task1").at("analysed"), 12) << "the version of most people comes first";
  ASSERT_EQ(json.at("apart").size(), 1u);
  EXPECT_EQ(json.at("apart")[0].at("flow").at("task1").at("analysed"), 3);
  EXPECT_EQ(json.at("roster").at("protocols").at(0).at("sections"), study::Json{"apart 1"});
  // The protocol's version with twelve people has the same results if it is analysed without the other
  // version.
  const study::Json alone = results_of({{made_study::task1(12)}, 2});
  EXPECT_EQ(json.at("task1"), alone.at("task1"));
  EXPECT_EQ(json.at("hypotheses"), alone.at("hypotheses"));
}

TEST(ReportChoice, EachQuestionOfAPilotIsFitted) {
  const study::TaskStudy study{{pilot_of_two_questions()}, 0};
  const study::Json json = results_of(study);
  expect_true_page(json);
  EXPECT_EQ(json.at("pilot").at("question"), "satisfaction");
  EXPECT_EQ(json.at("pilot").at("level"), 4);
  ASSERT_EQ(json.at("apart").size(), 1u);
  const study::Json& other = json.at("apart")[0].at("pilot");
  EXPECT_EQ(other.at("question"), "smoothness");
  EXPECT_EQ(other.at("level"), 1.5) << "the middle of 0 to 3";
  EXPECT_EQ(other.at("status"), "ok") << other.at("reason");
  EXPECT_FALSE(other.contains("level5")) << "5 is no score of this scale";
  // Each question is described once.
  EXPECT_EQ(json.at("descriptives").size(), 1u);
  EXPECT_EQ(json.at("apart")[0].at("descriptives").size(), 1u);
  const study::Json chosen = results_of(study, made_study::quick_plan(), "smoothness");
  EXPECT_FALSE(chosen.contains("apart"));
  EXPECT_EQ(chosen.at("pilot").at("a"), other.at("a"));
}

TEST(ReportChoice, SicknessAskedInTrialsIsNoRatingOfFrameRates) {
  auto pilot = testing_pilot::simulated_pilot("ptpe:a=24,b=0.02", 6, 7);
  pilot.questions.push_back(made_study::scale("fms", 0, 20));
  const study::Json json = results_of({{pilot}, 0});
  EXPECT_FALSE(json.contains("apart"));
  EXPECT_EQ(json.at("pilot").at("question"), "satisfaction");
}

TEST(ReportChoice, ProtocolsSetAsideAreInTheRoster) {
  auto test = mended(made_study::task2(2), '6');
  for (auto& session : test.sessions) session.test_data = true;
  const study::Json json = results_of({{made_study::task2(9), test}, 0});
  EXPECT_EQ(json.at("roster").at("sessions"), 11);
  EXPECT_EQ(json.at("roster").at("protocols").at(1).at("sections"), study::Json::array());
  EXPECT_EQ(json.at("roster").at("protocols").at(1).at("test_data"), 2);
  EXPECT_EQ(json.at("flow").at("task2").at("set_aside").at("protocols"), 2);
  EXPECT_EQ(report_walk::sessions_in_flows(json), 11) << "each session stands in a flow";
  EXPECT_NE(study::report::results_page(json).find("set aside"), std::string::npos);
}

// Two files of the same name and version differ only in their hashes.
TEST(ReportChoice, AProtocolSetAsideIsNotTakenForTheOneAnalysed) {
  auto test = comfort(1);
  test.sha256 = std::string(64, '6');
  for (auto& session : test.sessions) session.test_data = true;
  const study::Json json = results_of({{test, comfort(4)}, 0});
  expect_true_page(json);
  const std::string notes = json.at("study").at("notes").dump();
  EXPECT_THAT(notes, HasSubstr("666666666666, 1 session"));
}

TEST(ReportChoice, OneBannerNamesEachVersionAndCountsPeopleOnce) {
  const study::Json json = results_of({{comfort(12), mended(comfort(3), '5')}, 0});
  expect_true_page(json);
  EXPECT_EQ(json.at("study").at("simulated_people"), 12) << "the three of version 1.1 are among the twelve";
  std::string banner;
  int banners = 0;
  for (const auto& block : report_blocks::blocks_of(json)) {
    if (block.words.find("come from a model") == std::string::npos) continue;
    ++banners;
    banner = block.words;
  }
  EXPECT_EQ(banners, 1);
  EXPECT_THAT(banner, HasSubstr("(comfort, version 1.0) and Own design (comfort, version 1.1)"));
}

TEST(ReportChoice, RealismAloneIsAnalysed) {
  auto task = made_study::task1(12);
  std::erase_if(task.questions, [](const auto& one) { return one.id != "realism"; });
  for (auto& session : task.sessions)
    for (auto& trial : session.trials)
      std::erase_if(trial.answers, [](const auto& one) { return one.question != "realism"; });
  const study::Json json = results_of({{task}, 0});
  expect_true_page(json);
  EXPECT_EQ(json.at("task1").at("scores").size(), 1u);
  EXPECT_EQ(json.at("task1").at("comparisons").size(), 20u);
  EXPECT_TRUE(json.at("hypotheses").empty());
  EXPECT_EQ(json.at("not_analysed"),
            (study::Json{
                {{"task", "task1"},
                 {"protocol", "task1"},
                 {"what", "H1 to H3"},
                 {"reason",
                  "the trials ask no question 'disorientation', 'unrealism', 'dizziness' or 'confusion' on "
                  "a scale"}}}));
}

// The page says that values beyond the whiskers are drawn and listed: it must print each value, not only
// their number.
TEST(ReportChoice, ValuesBeyondTheWhiskersAreListed) {
  auto task = made_study::task1(12);
  for (auto& trial : task.sessions[0].trials)
    if (trial.first.what.method == "LoRes") trial.answers[0].score = 7;
  const study::Json json = results_of({{task}, 0});
  expect_true_page(json);
  std::size_t outliers = 0, printed = 0;
  for (const auto& cell : json.at("task1").at("cells")) outliers += cell.at("outliers").size();
  for (const auto& text : html_reader::read(study::report::results_page(json)).texts)
    printed += text.attribute("data-field").find("/outliers/") != std::string::npos && !text.within("svg");
  EXPECT_GT(outliers, 0u);
  EXPECT_EQ(printed, outliers);
}

TEST(ReportChoice, RulesThatCannotActAreNotStated) {
  const auto rules = [](const study::TaskProtocol& protocol) {
    return results_of({{protocol}, 0}).at("study").at("protocols").at(0).at("rules").dump();
  };
  auto caught = comfort(4);
  EXPECT_THAT(rules(caught), AllOf(HasSubstr("timing"), Not(HasSubstr("catch")), Not(HasSubstr("repeat"))));
  for (auto& session : caught.sessions) session.catches = {{"attention", 2, 2}};
  EXPECT_THAT(rules(caught), HasSubstr("catch"));
}

TEST(ReportChoice, TrackedGazeIsSaidOfMethodsThatFollowIt) {
  EXPECT_EQ(results_of({{comfort(4)}, 0}).at("study").at("tracked_gaze"), study::Json());
  auto foveated = comfort(4);
  foveated.methods = {"LoRes", "FovFluid"};
  for (auto& session : foveated.sessions)
    for (auto& trial : session.trials)
      if (trial.first.what.method == "HiRes") trial.first.what.method = "FovFluid";
  EXPECT_EQ(results_of({{foveated}, 0}).at("study").at("tracked_gaze"), false);
}

TEST(ReportChoice, AnOwnDesignSaysWhatIsNotTestedAndWhyThereAreNoTimes) {
  auto own = comfort(4);
  for (auto& session : own.sessions)
    for (auto& trial : session.trials)
      for (auto& answer : trial.answers) answer.response_time_s = 0;
  const study::Json json = results_of({{own}, 0});
  expect_true_page(json);
  EXPECT_EQ(json.at("not_analysed").at(1).at("what"), "H1 to H3");
  EXPECT_THAT(json.at("response_times").at(0).at("reason").get<std::string>(), HasSubstr("simulated"));
}

TEST(ReportChoice, AHypothesisAboutAMethodThatIsNotShownIsNotTested) {
  auto task = made_study::task1(12);
  for (auto& session : task.sessions)
    std::erase_if(session.trials, [](const auto& trial) { return trial.first.what.method == "FovFluid"; });
  std::erase(task.methods, "FovFluid");
  const study::Json json = results_of({{task}, 0});
  expect_true_page(json);
  ASSERT_EQ(json.at("hypotheses").size(), 2u);
  EXPECT_EQ(json.at("hypotheses")[0].at("id"), "H2");
  EXPECT_EQ(json.at("not_analysed"), (study::Json{{{"task", "task1"},
                                                   {"protocol", "task1"},
                                                   {"what", "H1"},
                                                   {"reason", "the protocol does not show FovFluid"}}}));
}

/// Each of six people judges one pair in three scenes. `alike`: all always choose HiRes.
study::TaskProtocol pairs_over_scenes(bool alike) {
  auto pairs = of_two_methods("pairs", '7', true, 6);
  study::Question choice;
  choice.id = "smoother";
  choice.kind = study::AnswerKind::Choice;
  choice.anchors = {{1, "first"}, {2, "second"}};
  pairs.questions = {choice};
  for (int person = 0; person < 6; ++person) {
    auto visit = made_study::session(made_study::code(person), "none");
    for (int position = 0; position < 3; ++position) {
      study::TaskTrial trial;
      trial.position = position;
      trial.kind = "stimulus";
      const auto& scene = made_study::scenes[static_cast<std::size_t>(position)];
      const bool swapped = person % 2 != 0;
      trial.first = made_study::showing(scene, swapped ? "HiRes" : "LoRes", "1k");
      trial.second = made_study::showing(scene, swapped ? "LoRes" : "HiRes", "1k");
      const bool chosen = alike || position > person % 3;  // HiRes is chosen
      trial.answers = {{"smoother", swapped == chosen ? 1 : 2}};
      visit.trials.push_back(trial);
    }
    pairs.sessions.push_back(visit);
  }
  return pairs;
}

TEST(ReportChoice, PairsOverScenesAreDescribedByScene) {
  const study::Json json = results_of({{pairs_over_scenes(true)}, 0});
  expect_true_page(json);
  const study::Json& cells = json.at("descriptives").at(0).at("cells");
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_EQ(cells[0].at("shown"), "LoRes and HiRes");
  EXPECT_EQ(cells[0].at("distribution"),
            (study::Json{{{"answer", "LoRes"}, {"count", 0}}, {{"answer", "HiRes"}, {"count", 6}}}));
  EXPECT_TRUE(json.at("hypotheses").empty());
  EXPECT_THAT(json.at("task2").at("pairs").at(0).at("by_person").at("ci_name").get<std::string>(),
              HasSubstr("Clopper-Pearson over people"));
}

// People judged the pair several times, so the test over people applies: the page names it, prints and draws
// its interval, and does not mention the binomial test.
TEST(ReportChoice, PairsAnsweredSeveralTimesNameTheTestThatWasMade) {
  const study::Json json = results_of({{pairs_over_scenes(false)}, 0});
  expect_true_page(json);
  const study::Json& task = json.at("task2");
  EXPECT_EQ(task.at("several_answers"), (study::Json{{"participants", 6}, {"of", 6}, {"most", 3}}));
  EXPECT_EQ(task.at("pairs").at(0).at("test"), "exact permutation test of people's shares");
  EXPECT_EQ(task.at("pairs").at(0).at("warning"), "");
  EXPECT_THAT(task.at("rules").at("tests").get<std::string>(), Not(HasSubstr("inomial")));
  EXPECT_THAT(task.at("triads").at("refused").get<std::string>(), HasSubstr("fewer than three methods"));
  EXPECT_THAT(task.at("detectable").at("reason").get<std::string>(), HasSubstr("how alike one person's"));
  const std::string html = study::report::results_page(json);
  const std::string section = html.substr(html.find("id=\"task2\""), html.find("id=\"descriptives\""));
  const std::string pairs = section.substr(0, section.find("Bias towards the first interval"));
  EXPECT_THAT(pairs, AllOf(Not(HasSubstr("inomial")), Not(HasSubstr("Wilson)"))));
  EXPECT_EQ(pairs.find("answered a pair more than once"), pairs.rfind("answered a pair more than once"));
  std::size_t printed = 0;
  for (const auto& text : html_reader::read(html).texts)
    printed += text.attribute("data-field") == "/task2/pairs/0/by_person/ci/0";
  EXPECT_EQ(printed, 2u) << "in the table and in APA style";
  EXPECT_NE(pairs.find("stroke-width=\"4.5\""), std::string::npos) << "the interval's line";
  // If each pair was answered once, everything refers to the binomial test.
  const study::Json once = results_of({{made_study::task2(9)}, 0});
  EXPECT_EQ(once.at("task2").at("pairs").at(0).at("test"), "exact binomial test");
  EXPECT_FALSE(once.at("task2").at("rules").contains("more_than_one_trial"));
}

TEST(ReportChoice, ReasonsCallMethodsByTheirNames) {
  const study::Json few = results_of({{made_study::task1(3)}, 2});
  std::string reasons;
  for (const auto& model : few.at("task1").at("ordinal")) {
    reasons += model.value("why_penalised", "") + "; ";
    EXPECT_EQ(model.value("penalty", ""), model.value("why_penalised", "").empty() ? "" : "log-F(1, 1)");
  }
  expect_true_page(few);
  EXPECT_THAT(reasons, AllOf(HasSubstr("overlap by LoRes, FovFluid"), Not(HasSubstr("method0"))));
  auto pairs = made_study::task2(4);
  for (auto& session : pairs.sessions) {
    for (auto& trial : session.trials) {
      const bool first = trial.first.what.method == "Ours", second = trial.second->what.method == "Ours";
      if (first || second) trial.answers = {{"preference", first ? 1 : 2}};
    }
  }
  const study::Json winner = results_of({{pairs}, 0});
  EXPECT_EQ(winner.at("task2").at("bradley_terry").at("why_penalised"),
            "Ours wins every comparison with the others");
  expect_true_page(winner);
  EXPECT_EQ(study::with_names("items 1, 3 together lose; method1:x", {"a", "b", "c"}),
            "a, c together lose; b:x");
}

TEST(ReportChoice, TablesOfWhatStandsApartHaveFoldersOfTheirOwn) {
  const study::Json json = results_of({{mended(made_study::task1(3), '5'), made_study::task1(12)}, 2});
  std::set<std::string> files;
  study::write_csv_folder(json, "csv", [&](const std::filesystem::path& path, const std::string& bytes) {
    EXPECT_TRUE(files.insert(path.string()).second) << path;
    EXPECT_FALSE(bytes.empty());
  });
  for (const char* file : {"csv/descriptives.csv", "csv/roster.csv", "csv/apart_1/task1_cells.csv"})
    EXPECT_TRUE(files.contains(file)) << file;
}

}  // namespace
}  // namespace apps
