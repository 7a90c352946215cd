/// vip-stats study: answers of studies with factors, declared tests, thresholds.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libstudy/analysis/tasks/study_results.hpp"
#include "libstudy/report/page.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/report_walk.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using report_walk::Json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A study in memory, without a database: the protocol `text`, and people's answers to it.
struct MadeStudy {
  study::TaskStudy study;

  explicit MadeStudy(const std::string& text) {
    auto& protocol = study.protocols.emplace_back();
    protocol.whole = std::make_shared<const study::Protocol>(study::parse_protocol(text, "made.toml"));
    protocol.name = protocol.whole->name;
    protocol.version = protocol.whole->version;
    protocol.sha256 = protocol.whole->sha256;
    protocol.pairs = protocol.whole->design.pairs;
    for (const auto& [block, question] : study::all_questions(*protocol.whole))
      if (question->id != "take_part") protocol.questions.push_back(*question);
  }
  study::TaskProtocol& protocol() { return study.protocols.front(); }
  const study::Protocol& whole() const { return *study.protocols.front().whole; }

  /// Adds a trial of a person. All trials of a person must be added one after another.
  void answer(const std::string& person, int first, std::optional<int> second, int score) {
    auto& sessions = protocol().sessions;
    if (sessions.empty() || sessions.back().participant != person) {
      sessions.emplace_back();
      sessions.back().participant = person;
      sessions.back().state = "done";
      sessions.back().uid = "session of " + person;
    }
    auto& trial = sessions.back().trials.emplace_back();
    trial.position = static_cast<int>(sessions.back().trials.size()) - 1;
    trial.kind = "stimulus";
    trial.first.cell = first;
    trial.first.played = true;
    trial.first.realised.frames = 240;
    if (second) {
      trial.second.emplace();
      trial.second->cell = *second;
      trial.second->played = true;
    }
    trial.answers.push_back({protocol().questions.front().id, score});
  }

  Json results(const std::string& tables, const std::optional<Json>& since = {},
               const std::optional<study::FrozenFacts>& frozen = {}) const {
    const TemporaryFolder folder;
    base::write_file_atomically(folder / "plan.toml", "format = 1\n" + tables);
    study::FactorStudyRequest request{.database = "made.db",
                                      .plan = study::read_plan(folder / "plan.toml", &whole())};
    request.frozen = frozen;
    request.since = since;
    request.since_file = "old.json";
    return study::factor_study_json(study, study::factor_protocol(study, "", "made.db"), request);
  }
};

/// Ten people of each content. The share of yes at 100 ms is planted: person i says yes in i % 4 + 1 of 5
/// trials there, and in one trial at 50 ms.
MadeStudy made_hitches() {
  MadeStudy out(shipped_text("hitches"));
  for (int i = 0; i < 20; ++i) {
    const int group = i < 10 ? 0 : 6;  // cells of content dam, then of drop
    const std::string person = (i < 9 ? "P0" : "P") + std::to_string(i + 1);
    for (int trial = 0; trial < 5; ++trial) {
      out.answer(person, group + 4, {}, trial <= i % 4 ? 1 : 0);
      out.answer(person, group + 2, {}, trial == 0 ? 1 : 0);
    }
  }
  return out;
}

std::string declared(const std::string& id, const std::string& compare, const std::string& more) {
  return "[[hypothesis]]\nid = \"" + id + "\"\noutcome = \"stall\"\ncompare = [" + compare + "]\n" + more +
         "\n";
}

TEST(FactorStudy, TestsOneValueOfEachParticipant) {
  const auto json = made_hitches().results(
      declared("a", "{hitch = \"h100\"}, {hitch = \"h50\"}", "test = \"paired_t\"\nfamily = \"f\"") +
      declared("b", "{hitch = \"h100\", content = \"dam\"}, {hitch = \"h100\", content = \"drop\"}",
               "test = \"welch_t\"\nfamily = \"f\"") +
      declared("c", "{hitch = \"h100\", content = \"dam\"}, {hitch = \"h50\", content = \"dam\"}",
               "test = \"wilcoxon\"") +
      declared("d", "{hitch = \"h150\"}, {hitch = \"h50\"}", "test = \"paired_t\""));
  const Json& tests = json.at("hypotheses");
  // The people's differences are 0, .2, .4, .6 in turn, for five people each.
  const Json& a = tests.at(0);
  EXPECT_EQ(a.at("n_a"), 20);
  EXPECT_NEAR(a.at("estimate").get<double>(), 0.3, 1e-12);
  const double se = std::sqrt(1.0 / 19 / 20);  // squares about the mean: 10 (.09 + .01)
  EXPECT_NEAR(a.at("statistic_value").get<double>(), 0.3 / se, 1e-9);
  EXPECT_EQ(a.at("df"), 19);
  EXPECT_EQ(a.at("holds"), true);
  EXPECT_EQ(a.at("status"), "declared");
  // Holm over the family of two: the smaller p is doubled.
  EXPECT_DOUBLE_EQ(a.at("p_adjusted").get<double>(), 2 * a.at("p").get<double>());
  const Json& b = tests.at(1);
  EXPECT_EQ(b.at("n_a"), 10) << "other people see the other content";
  EXPECT_EQ(b.at("n_b"), 10);
  EXPECT_EQ(b.at("p_adjusted"), b.at("p"));
  EXPECT_EQ(tests.at(2).at("n_a"), 10) << "the other group has no part in it";
  EXPECT_EQ(tests.at(3).at("holds"), false);
  EXPECT_FALSE(tests.at(3).at("reason").get<std::string>().empty()) << "nobody saw 150 ms";
  EXPECT_EQ(json.at("groups").at(1).at("participants"), 10);
  EXPECT_EQ(json.at("sensitivity").size(), 4u);
}

TEST(FactorStudy, IntervalsOfSharesStayWithinNoughtAndOne) {
  MadeStudy made(shipped_text("hitches"));
  for (int i = 0; i < 4; ++i) {
    const std::string person = "P" + std::to_string(i);
    made.answer(person, 2, {}, i == 0 ? 1 : 0);  // Student's interval of 0, 0, 0, 1 begins at -0.55
    made.answer(person, 4, {}, 0);               // nobody says yes
  }
  const Json cells = made.results("").at("descriptives").at(0).at("cells");
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells.at(0).at("ci").at(0), 0);
  EXPECT_EQ(cells.at(0).at("ci").at(1), 1);
  EXPECT_EQ(cells.at(1).at("ci").at(0), 0);
  // Clopper and Pearson for 0 of 4: 1 - 0.025^(1/4).
  EXPECT_NEAR(cells.at(1).at("ci").at(1).get<double>(), 1 - std::pow(0.025, 0.25), 1e-9);
}

TEST(FactorStudy, DescribesEachCellOverParticipants) {
  const auto made = made_hitches();
  const auto json = made.results("");
  EXPECT_EQ(json.at("hypotheses"), Json::array());
  const Json& question = json.at("descriptives").at(0);
  EXPECT_EQ(question.at("exploratory"), true) << "no hypothesis declares it";
  ASSERT_EQ(question.at("cells").size(), 4u);
  const Json& cell = question.at("cells").at(1);
  EXPECT_EQ(cell.at("cell"), "hitch h100, content dam");
  EXPECT_EQ(cell.at("participants"), 10);
  EXPECT_EQ(cell.at("trials"), 50);
  EXPECT_NEAR(cell.at("mean").get<double>(), 0.46, 1e-12);  // people's means: .2 .4 .6 .8 in turn
  EXPECT_EQ(cell.at("counts").at(1).at("n"), 23);
  EXPECT_EQ(made.results(declared("a", "{hitch = \"h100\"}", "against = 0.5\ntest = \"binomial\""))
                .at("descriptives")
                .at(0)
                .at("exploratory"),
            false);
  // A bundle counts as a preregistration if its files are unchanged and it has the protocol.
  const std::string test = declared("a", "{hitch = \"h100\"}", "against = 0.5\ntest = \"binomial\"");
  const auto status = [&](const study::FrozenFacts& frozen) {
    return made.results(test, {}, frozen).at("hypotheses").at(0).at("status").get<std::string>();
  };
  EXPECT_EQ(status({"hash", "2020-01-01T00:00:00Z", {}, {made.whole().sha256}}), "preregistered");
  EXPECT_EQ(status({"hash", "2020-01-01T00:00:00Z", {"plan.toml"}, {made.whole().sha256}}), "declared");
  EXPECT_EQ(status({"hash", "2020-01-01T00:00:00Z", {}, {"other"}}), "declared");
  // New people are those whose sessions the earlier result lacks.
  auto grown = made_hitches();
  grown.answer("P21", 0, {}, 0);
  const auto later = grown.results("", json);
  EXPECT_EQ(later.at("since").at("new"), 1);
  EXPECT_EQ(later.at("participants").at(20).at("new"), true);
  EXPECT_EQ(later.at("participants").at(0).at("new"), false);
  EXPECT_THROW(grown.results("", Json{{"schema", "vip-results/1"}}), base::Error);
}

TEST(FactorStudy, AnAnswerThatIsMissingLeavesTheParticipantOut) {
  auto made = made_hitches();
  made.answer("P21", 4, {}, 1);  // never saw 50 ms
  const auto json =
      made.results(declared("a", "{hitch = \"h100\"}, {hitch = \"h50\"}", "test = \"paired_t\""));
  EXPECT_EQ(json.at("hypotheses").at(0).at("n_a"), 20);
  EXPECT_EQ(json.at("hypotheses").at(0).at("n_missing"), 1);
}

TEST(FactorStudy, PairsGiveTheShareThatChoseTheComparison) {
  MadeStudy made(shipped_text("trace_smoothed"));
  const auto& choice = made.protocol().questions.front();
  const int first = choice.anchors.front().first, second = choice.anchors.back().first;
  // Cell 0 is the standard. The first person chooses "captured" (cell 1) in all four trials, the others in
  // three.
  for (int i = 0; i < 6; ++i) {
    const std::string person = "P0" + std::to_string(i + 1);
    made.answer(person, 0, 1, second);
    made.answer(person, 1, 0, first);
    made.answer(person, 1, 0, first);
    made.answer(person, 0, 1, i == 0 ? second : first);
  }
  const auto json = made.results("[[hypothesis]]\nid = \"a\"\noutcome = \"" + choice.id +
                                 "\"\ncompare = [{frames = \"captured\"}]\ntest = \"binomial\"\n");
  EXPECT_EQ(json.at("descriptives").at(0).at("value"), "comparison");
  EXPECT_NEAR(json.at("descriptives").at(0).at("cells").at(0).at("mean").get<double>(), 4.75 / 6, 1e-12);
  const Json& test = json.at("hypotheses").at(0);
  EXPECT_EQ(test.at("estimate"), 1.0) << "all are above one half";
  EXPECT_NEAR(test.at("p").get<double>(), 2.0 / 64, 1e-12);
  EXPECT_EQ(test.at("b"), "0.5");
}

Ended typed(const std::string& line) { return run_shell(VIP_BIN_DIR "/" + line); }
std::string text_in(const std::filesystem::path& path) { return base::read_file(path, 1 << 24); }

TEST(FactorStudyE2e, GoesFromSimulatedPeopleToThePage) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  base::write_file_atomically(folder / "quest.toml",
                              replaced(shipped_text("hitch_quest"), "trials = 40", "trials = 12"));
  base::write_file_atomically(folder / "plan.toml",
                              "format = 1\n[[hypothesis]]\nid = \"below\"\noutcome = \"threshold\"\n"
                              "compare = [{}]\nagainst = 200\ntest = \"paired_t\"\nalternative = \"less\"\n");
  const auto run = [&](const std::string& people) {
    return typed("vip-study run " + at("quest.toml") + " --db " + at("s.db") + " " + people +
                 " --observer detect:hitch_ms,threshold=80,spread=0.2 --seed 5");
  };
  ASSERT_EQ(run("--participants 3").exit_code, 0);
  const auto study = [&](const std::string& more) {
    return typed("vip-stats study --db " + at("s.db") + " --json " + at("r.json") + more);
  };
  const auto first = study(" --plan " + at("plan.toml") + " --html " + at("r.html") + " --csv " + at("t"));
  ASSERT_EQ(first.exit_code, 0) << first.out << first.err;
  EXPECT_THAT(first.out, HasSubstr("below        threshold: all cells against 200"));
  const Json json = Json::parse(text_in(folder / "r.json"));
  EXPECT_EQ(json.at("hypotheses").at(0).at("holds"), true) << "the planted threshold is 80 ms";
  EXPECT_EQ(json.at("thresholds").at("participants").size(), 3u);
  EXPECT_EQ(json.at("thresholds").at("exploratory"), false);
  int trials = 0;
  for (const Json& point : json.at("thresholds").at("tracks").at(0).at("points"))
    trials += point.at("trials").get<int>();
  EXPECT_EQ(trials, 36);
  for (const Json& cell : json.at("timing")) EXPECT_THAT(cell.at("asked").text(), HasSubstr("a hitch of"));
  const auto page = html_reader::read(text_in(folder / "r.html"));
  EXPECT_THAT(report_walk::wrong_fields(page, json), IsEmpty());
  EXPECT_THAT(report_walk::unmarked_numbers(page, json), IsEmpty());
  EXPECT_THAT(report_walk::wrong_references(page), IsEmpty());
  EXPECT_THAT(text_in(folder / "r.html"), HasSubstr("Exploratory"));
  EXPECT_THAT(text_in(folder / "t" / "thresholds.csv"), HasSubstr("threshold_ci_low"));
  EXPECT_FALSE(std::filesystem::exists(folder / "t" / "exclusions.csv")) << "nothing was excluded";

  ASSERT_EQ(run("--participant P04 P05").exit_code, 0);
  const auto later = study(" --since " + at("r.json"));
  EXPECT_THAT(later.out, HasSubstr("2 of 5 participants are new since r.json"));
  EXPECT_THAT(later.out, HasSubstr("no hypothesis is declared: every result is exploratory"));

  // A bundle that was frozen after the first answer is no preregistration.
  ASSERT_EQ(typed("vip-stats preregister " + at("quest.toml") + " --plan " + at("plan.toml") + " --out " +
                  at("bundle"))
                .exit_code,
            0);
  const auto late = study(" --preregistered " + at("bundle"));
  EXPECT_THAT(late.out, HasSubstr("not preregistered: the bundle, frozen"));
  EXPECT_EQ(Json::parse(text_in(folder / "r.json")).at("hypotheses").at(0).at("status"), "declared");

  // vip-stats report says that the plan's hypothesis lacks the key task, which the report needs.
  const auto report =
      typed("vip-stats report " + at("s.db") + " --json " + at("old.json") + " --plan " + at("plan.toml"));
  ASSERT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(text_in(folder / "old.json"), HasSubstr("it lacks the key task"));
}

TEST(FactorStudyE2e, RefusesOtherProtocols) {
  const TemporaryFolder folder;
  const auto db = (folder / "s.db").string();
  ASSERT_EQ(typed("vip-study run demo --db " + db + " --participants 1 --observer random").exit_code, 0);
  const auto refused = typed("vip-stats study " + db);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err + refused.out, HasSubstr("holds no protocol with factors"));
}

}  // namespace
}  // namespace apps::test
