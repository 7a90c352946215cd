/// Preregistration: one hash over everything that is fixed, and later differences from it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <sstream>

#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/preregistration/line_difference.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/simulated_pilot.hpp"
#include "tests/common/protocols.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

study::report::BundleRequest both_tasks() {
  study::report::BundleRequest request;
  request.protocols = {"protocols/task1.toml", "protocols/task2.toml"};
  request.plan.resamples = 200;
  request.plan.seed = 7;
  return request;
}

study::ProtocolRow row_of(const study::Protocol& protocol) {
  study::ProtocolRow row;
  row.name = protocol.name;
  row.version = protocol.version;
  row.sha256 = protocol.sha256;
  row.text = protocol.text;
  return row;
}

/// Answers to both tasks under these protocols, analysed under the bundle's plan.
struct Study {
  std::vector<study::ProtocolRow> rows;
  study::Json results;
};

study::Protocol protocol(const std::string& name) {
  return study::read_protocol(base::resource("protocols/" + name));
}

/// `change` gets the answers to Tasks 1 and 2.
Study answered(const study::report::Bundle& bundle, const study::Protocol& task1 = protocol("task1.toml"),
               const std::function<void(study::TaskProtocol&, study::TaskProtocol&)>& change = {}) {
  const auto task2 = protocol("task2.toml");
  auto one = made_study::task1(12), two = made_study::task2(12);
  one.sha256 = task1.sha256;
  two.sha256 = task2.sha256;
  if (change) change(one, two);
  return {{row_of(task1), row_of(task2)},
          study::make_results({{one, two}, 0},
                              {"study.db", {study::TaskKind::Task1, study::TaskKind::Task2}, "", bundle.plan})
              .json};
}

study::Json compared(const study::report::Bundle& bundle, const Study& study) {
  return study::report::compare_with_bundle(bundle, study.rows, study.results);
}

study::report::Bundle frozen(const fs::path& folder,
                             const study::report::BundleRequest& request = both_tasks()) {
  study::report::freeze_bundle(request, folder);
  return study::report::read_bundle(folder);
}

TEST(Preregistration, ItsHashIsThatOfTheManifestAndTheManifestHoldsEveryFile) {
  const TemporaryFolder folder;
  const auto hash = study::report::freeze_bundle(both_tasks(), folder / "bundle");
  const auto checked = test::run_shell("cd '" + (folder / "bundle").string() +
                                       "' && sha256sum -c MANIFEST.sha256 && sha256sum MANIFEST.sha256");
  EXPECT_EQ(checked.exit_code, 0) << checked.out;
  EXPECT_THAT(checked.out, HasSubstr(hash));
  for (const auto& entry : fs::directory_iterator(folder / "bundle")) {
    const auto name = entry.path().filename().string();
    if (name != "MANIFEST.sha256") {
      EXPECT_THAT(checked.out, HasSubstr(name + ": OK"));
    }
  }
  const auto bundle = study::report::read_bundle(folder / "bundle");
  EXPECT_EQ(bundle.sha256, hash);
  EXPECT_THAT(bundle.altered, IsEmpty());
  EXPECT_EQ(bundle.plan.plan.seed, 7u);
  EXPECT_TRUE(bundle.protocols.contains(protocol("task1.toml").sha256));
}

TEST(Preregistration, FixesAllSixHypothesesWithTheirMargins) {
  const TemporaryFolder folder;
  auto request = both_tasks();
  request.plan.margin_realism = 0.4;
  const auto bundle = frozen(folder / "bundle", request);
  std::vector<std::string> ids;
  std::vector<std::size_t> families;
  for (const auto& hypothesis : bundle.hypotheses) {
    ids.push_back(hypothesis.at("id"));
    families.push_back(hypothesis.at("tests").size());
  }
  EXPECT_EQ(ids, (std::vector<std::string>{"H1", "H2", "H3", "H4", "H5", "H6"}));
  EXPECT_EQ(families, (std::vector<std::size_t>{8, 8, 4, 1, 2, 2}));
  std::set<double> margins;
  for (const auto& test : bundle.hypotheses.at(1).at("tests"))
    margins.insert(test.at("margin").get<double>());
  EXPECT_EQ(margins, (std::set<double>{0.25, 0.4}));
}

TEST(Preregistration, NamesTheLevelOfAPilotsCurve) {
  const TemporaryFolder folder;
  const auto freeze = [&](const std::string& level, const char* name) {
    base::write_file_atomically(
        folder / "pilot.toml",
        ::test::replaced(::test::shipped_text("ptpe_pilot"), "scale = [1, 7]\n", "scale = [1, 7]\n" + level));
    study::report::BundleRequest request;
    request.protocols = {folder / "pilot.toml"};
    return frozen(folder / name, request).plan.plan.levels;
  };
  EXPECT_EQ(freeze("", "middle"), (std::map<std::string, double>{{"satisfaction", 4}}));
  EXPECT_EQ(freeze("level = 4.5\n", "named"), (std::map<std::string, double>{{"satisfaction", 4.5}}));
  EXPECT_THAT(base::read_file(folder / "named" / "PREREGISTRATION.txt", 1 << 20),
              HasSubstr("the curve of question satisfaction is fitted at level 4.5 of its scale, 1 to 7"));

  // If the curve is fitted at another level, the page says so.
  const auto bundle = study::report::read_bundle(folder / "named");
  auto pilot = testing_pilot::simulated_pilot("ptpe:a=24,b=0.02", 6, 7);
  pilot.sha256 = bundle.protocols.begin()->first;
  study::ProtocolRow row;
  row.name = "ptpe_pilot";
  row.sha256 = pilot.sha256;
  study::ResultsRequest request{"study.db", {study::TaskKind::Pilot}, "", bundle.plan};
  const auto differences = [&] {
    return study::report::compare_with_bundle(bundle, {row}, study::make_results({{pilot}, 0}, request).json)
        .at("differences")
        .dump();
  };
  EXPECT_THAT(differences(), Not(HasSubstr("level")));
  request.level = 4;
  EXPECT_THAT(differences(), HasSubstr("preregistered at level 4.5, fitted at 4"));
}

TEST(Preregistration, AStudyThatKeepsToItDiffersInNothing) {
  const TemporaryFolder folder;
  const auto bundle = frozen(folder / "bundle");
  const auto check = compared(bundle, answered(bundle));
  EXPECT_EQ(check.at("differences"), study::Json::array());
  EXPECT_EQ(check.at("tasks"), (study::Json{{"task1", true}, {"task2", true}}));
  EXPECT_TRUE(check.at("holds").get<bool>());
}

/// Task 1's first answer is at `first`, Task 2's is long after the bundle.
study::Json check_with_first_answer(const study::report::Bundle& bundle, const std::string& first) {
  return compared(bundle, answered(bundle, protocol("task1.toml"), [&](auto& one, auto& two) {
                    for (auto* task : {&one, &two})
                      for (auto& session : task->sessions) session.first_answer_utc = "2999-12-31T00:00:00Z";
                    one.sessions[7].first_answer_utc = first;
                  }));
}

TEST(Preregistration, SaysWhetherTheBundleIsOlderThanTheFirstAnswer) {
  const TemporaryFolder folder;
  const auto bundle = frozen(folder / "bundle");
  const std::string frozen = bundle.about.at("frozen_utc");
  const auto before = check_with_first_answer(bundle, "2999-01-01T00:00:00Z");
  EXPECT_TRUE(before.at("holds").get<bool>()) << before.dump(2);
  EXPECT_EQ(before.at("times")[0].at("text"),
            "The bundle was frozen before the first answer of Task 1, given 2999-01-01T00:00:00Z.");
  // If both times are in the same second, their order is not known: the bundle counts as late.
  for (const std::string& first : {std::string("2001-01-01T00:00:00Z"), frozen}) {
    const auto after = check_with_first_answer(bundle, first);
    EXPECT_EQ(after.at("tasks"), (study::Json{{"task1", false}, {"task2", true}}));
    EXPECT_EQ(after.at("times")[0].at("frozen_before"), false);
    EXPECT_EQ(after.at("times")[1].at("frozen_before"), true);
    EXPECT_THAT(
        after.at("differences"),
        Contains("The bundle was not frozen before the first answer of Task 1, given " + first + "."));
    EXPECT_THAT(after.at("summary").dump(), HasSubstr("differs"));
  }
}

// Rehearsals and observer models that are set aside do not make a bundle late.
TEST(Preregistration, OnlySessionsThatAreAnalysedHaveAFirstAnswer) {
  auto task = made_study::task1(6);
  for (auto& session : task.sessions) session.first_answer_utc = "2026-05-01T00:00:00Z";
  task.sessions[0].test_data = true;
  task.sessions[1].observer = "random";
  for (std::size_t i : {0u, 1u}) task.sessions[i].first_answer_utc = "2026-01-01T00:00:00Z";
  EXPECT_EQ(study::select_task({{task}, 0}, {study::TaskKind::Task1, "", {}})->first_answer_utc,
            "2026-05-01T00:00:00Z");
}

// A pilot beside the tasks is exploratory: a bundle of the tasks need not contain it.
TEST(Preregistration, APilotBesideTheTasksIsNoDifference) {
  const TemporaryFolder folder;
  const auto bundle = frozen(folder / "bundle");
  auto study = answered(bundle);
  const auto pilot = protocol("ptpe_pilot.toml");
  study.rows.push_back(row_of(pilot));
  study.results["study"]["protocols"].push_back({{"task", "pilot"},
                                                 {"title", "Pilot"},
                                                 {"sha256", pilot.sha256},
                                                 {"first_answer_utc", "2001-01-01T00:00:00Z"}});
  const auto check = compared(bundle, study);
  EXPECT_EQ(check.at("differences"), study::Json::array());
  EXPECT_EQ(check.at("tasks"), (study::Json{{"task1", true}, {"task2", true}, {"pilot", false}}));
}

TEST(Preregistration, AChangedProtocolIsNamedLineByLine) {
  const TemporaryFolder folder;
  const auto bundle = frozen(folder / "bundle");
  const auto text = ::test::replaced(::test::shipped_text("task1"), "duration_s = 30", "duration_s = 20");
  const auto check = compared(bundle, answered(bundle, study::parse_protocol(text, "task1.toml")));
  EXPECT_THAT(check.at("differences"), Contains("protocol task1, preregistered only: duration_s = 30"));
  EXPECT_THAT(check.at("differences"), Contains("protocol task1, used only: duration_s = 20"));
  EXPECT_EQ(check.at("tasks"), (study::Json{{"task1", false}, {"task2", true}}));
  EXPECT_FALSE(check.at("holds").get<bool>());
}

TEST(Preregistration, AnotherMarginIsNamed) {
  const TemporaryFolder folder;
  auto bundle = frozen(folder / "bundle");
  bundle.plan.plan.margin_sickness = 0.5;
  const auto check = compared(bundle, answered(bundle));
  EXPECT_EQ(check.at("tasks"), (study::Json{{"task1", false}, {"task2", true}}));
  EXPECT_THAT(check.at("differences").dump(),
              HasSubstr("H2, Ours - HiRes, sickness, 16k, margin: preregistered 0.25, tested 0.5"));
}

/// A bundle as it was written before plans had a decision rule: without the two keys of the rule.
void freeze_as_before(const fs::path& folder) {
  auto request = both_tasks();
  request.plan.decision = stats::DecisionRule::Holm;
  request.plan.directional = stats::Directional::Once;
  study::report::freeze_bundle(request, folder);
  std::istringstream lines(base::read_file(folder / "plan.toml", 1 << 20));
  std::string plan;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("decision") && !line.starts_with("directional")) plan += line + "\n";
  const auto before = base::sha256_hex(base::read_file(folder / "plan.toml", 1 << 20));
  base::write_file_atomically(folder / "plan.toml", plan);
  ::test::replace_in(folder / "MANIFEST.sha256", before, base::sha256_hex(plan));
}

TEST(Preregistration, AnEarlierBundleIsAnalysedUnderHolmAndDiffersInNothing) {
  const TemporaryFolder folder;
  freeze_as_before(folder / "bundle");
  const auto bundle = study::report::read_bundle(folder / "bundle");
  ASSERT_THAT(bundle.altered, IsEmpty());
  const auto study = answered(bundle);
  const auto check = compared(bundle, study);
  EXPECT_EQ(check.at("differences"), study::Json::array());
  EXPECT_EQ(study.results.at("plan").at("decision"), "holm");
  EXPECT_EQ(study.results.at("plan").at("directional"), "H2, H3 and H6");
  for (const auto& hypothesis : study.results.at("hypotheses"))
    for (const auto& test : hypothesis.at("tests")) EXPECT_EQ(test.at("holds"), test.at("holds_holm"));
}

TEST(Preregistration, AnotherDecisionRuleIsNamed) {
  const TemporaryFolder folder;
  freeze_as_before(folder / "bundle");
  auto bundle = study::report::read_bundle(folder / "bundle");
  bundle.plan.plan.decision = stats::DecisionRule::IntersectionUnion;
  const auto check = compared(bundle, answered(bundle));
  EXPECT_THAT(check.at("differences").dump(), HasSubstr("H1, rule: preregistered "));
  EXPECT_FALSE(check.at("holds").get<bool>());
}

TEST(Preregistration, TestsByTheMixedModelAreFrozenAndNotTakenForPairedOnes) {
  const TemporaryFolder folder;
  auto request = both_tasks();
  request.plan.tests = stats::ScoreTests::Mixed;
  auto bundle = frozen(folder / "bundle", request);
  EXPECT_EQ(bundle.plan.plan.tests, stats::ScoreTests::Mixed);
  const auto study = answered(bundle);
  EXPECT_EQ(compared(bundle, study).at("differences"), study::Json::array());
  bundle.plan.plan.tests = stats::ScoreTests::Paired;
  const auto check = compared(bundle, answered(bundle));
  EXPECT_THAT(check.at("differences").dump(), HasSubstr("H1, rule: preregistered \\\"t tests of the mixed"));
  EXPECT_EQ(check.at("tasks"), (study::Json{{"task1", false}, {"task2", true}}));
}

TEST(Preregistration, ATouchedFileTakesTheNameAway) {
  const TemporaryFolder folder;
  study::report::freeze_bundle(both_tasks(), folder / "bundle");
  auto plan = base::read_file(folder / "bundle/plan.toml", 1 << 20);
  EXPECT_NE(plan.find("[[hypothesis]]\nid = \"H1\""), std::string::npos)
      << "the shipped hypotheses are frozen";
  base::write_file_atomically(folder / "bundle/plan.toml", plan + "# \n");
  fs::remove(folder / "bundle/PREREGISTRATION.txt");
  const auto bundle = study::report::read_bundle(folder / "bundle");
  EXPECT_EQ(bundle.altered, (std::vector<std::string>{"PREREGISTRATION.txt", "plan.toml"}));
  const auto check = compared(bundle, answered(bundle));
  EXPECT_EQ(check.at("tasks"), (study::Json{{"task1", false}, {"task2", false}}));
}

TEST(Preregistration, ANameThatNoFileCanHaveIsAFileThatWasRemoved) {
  const TemporaryFolder folder;
  study::report::freeze_bundle(both_tasks(), folder / "bundle");
  const fs::path path = folder / "bundle/MANIFEST.sha256";
  const std::string name(300, 'n');
  base::write_file_atomically(path,
                              base::read_file(path, 1 << 20) + std::string(64, 'a') + "  " + name + "\n");
  EXPECT_EQ(study::report::read_bundle(folder / "bundle").altered, std::vector<std::string>{name});
}

TEST(Preregistration, AProtocolThatIsNotInItIsExploratory) {
  const TemporaryFolder folder;
  auto request = both_tasks();
  request.protocols.pop_back();
  const auto bundle = frozen(folder / "bundle", request);
  const auto check = compared(bundle, answered(bundle));
  EXPECT_EQ(check.at("tasks"), (study::Json{{"task1", true}, {"task2", false}}));
}

TEST(Preregistration, IsNeverWrittenOverAndLeavesNothingHalfDone) {
  const TemporaryFolder folder;
  const auto hash = study::report::freeze_bundle(both_tasks(), folder / "bundle");
  EXPECT_THAT([&] { study::report::freeze_bundle(both_tasks(), folder / "bundle"); },
              ThrowsMessage<base::Error>(HasSubstr("never overwritten")));
  EXPECT_EQ(study::report::read_bundle(folder / "bundle").sha256, hash);
  auto request = both_tasks();
  request.protocols.emplace_back("no_such_protocol.toml");
  EXPECT_THROW(study::report::freeze_bundle(request, folder / "other"), base::Error);
  request = both_tasks();
  request.protocols[1] = request.protocols[0];
  EXPECT_THROW(study::report::freeze_bundle(request, folder / "other"), base::Error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(Preregistration, AFolderThatIsNoBundleIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(study::report::read_bundle(folder.path()), base::Error);
  base::write_file_atomically(folder / "MANIFEST.sha256", std::string(64, 'a') + "  ../secret\n");
  EXPECT_THROW(study::report::read_bundle(folder.path()), base::Error);
  base::write_file_atomically(folder / "MANIFEST.sha256", "");
  EXPECT_THROW(study::report::read_bundle(folder.path()), base::Error);
}

/// For any content of a bundle's files the result is a comparison or an error with a remedy.
TEST(Preregistration, PartsThatAreNotWhatTheyShouldBeAreRefusedInWords) {
  const TemporaryFolder folder;
  study::report::freeze_bundle(both_tasks(), folder / "bundle");
  const std::vector<std::string> hostile{
      "",
      "{",
      "[]",
      "null",
      "7",
      "{\"schema\": 7}",
      "{\"schema\": \"vip-preregistration/1\"}",
      "[7]",
      "[{}]",
      "[{\"id\": 1, \"task\": \"task1\", \"tests\": []}]",
      "[{\"id\": \"H1\", \"task\": \"task1\", \"tests\": {}}]",
      "[{\"id\": \"H1\", \"task\": \"task1\", \"tests\": [7]}]",
      "[{\"id\": \"H1\", \"task\": \"task1\", \"tests\": [{\"label\": []}]}]",
      std::string(200'000, '['),
      "{\"schema\": \"vip-preregistration/1\", \"protocols\": 7, \"frozen_utc\": 1, \"vip_lab\": []}",
      "{\"schema\": \"vip-preregistration/1\", \"protocols\": [7], \"frozen_utc\": \"\", \"vip_lab\": \"\"}"};
  for (const char* name : {"about.json", "hypotheses.json"}) {
    for (const auto& text : hostile) {
      if (text == "[]" && std::string(name) == "hypotheses.json") continue;  // a pilot has no hypotheses
      const auto before = base::read_file(folder / ("bundle/" + std::string(name)), 1 << 20);
      base::write_file_atomically(folder / ("bundle/" + std::string(name)), text);
      EXPECT_THAT(
          [&] { study::report::read_bundle(folder / "bundle"); },
          ThrowsMessage<base::Error>(AllOf(HasSubstr(name), HasSubstr("mend: "), Not(HasSubstr("json.exc")))))
          << name << " " << text.substr(0, 80);
      base::write_file_atomically(folder / ("bundle/" + std::string(name)), before);
    }
  }
  EXPECT_NO_THROW(study::report::read_bundle(folder / "bundle"));
}

TEST(LineDifference, FindsWhatOneOfTwoTextsHas) {
  const auto found = study::report::line_difference("a\nb\nc\n", "a\nx\nc\ny");
  EXPECT_EQ(found.only_first, (std::vector<std::string>{"b"}));
  EXPECT_EQ(found.only_second, (std::vector<std::string>{"x", "y"}));
  EXPECT_TRUE(study::report::line_difference("a\r\n\nb", "a\nb \n").only_first.empty());
  EXPECT_EQ(study::report::line_difference("", "a").only_second.size(), 1u);
}

}  // namespace
}  // namespace apps
