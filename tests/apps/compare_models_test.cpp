/// vip-stats compare-models: what it says of pilots of simulated people, and what it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/rivals/compare_models.hpp"
#include "libstudy/analysis/rivals/proposals.hpp"
#include "libstudy/observer/observer.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/rival_study.hpp"

namespace {

using study::TimingPredictor;
using study::TimingPredictors;
using study::test::TemporaryFolder;
using ::testing::HasSubstr;

/// People who judge by one predictor, on the scale's points about a middle.
rival_study::Score judging_by(TimingPredictor predictor, double middle, double slope) {
  return [=](int person, const TimingPredictors& at) {
    const double v = at[static_cast<std::size_t>(predictor)];
    const auto count = static_cast<std::uint64_t>(std::llround(1e6 * (at[0] + at[2] + at[6])));
    const double noise = study::normal_of(11 + static_cast<std::uint64_t>(person), count);
    const double taste = 0.5 * study::normal_of(7, static_cast<std::uint64_t>(person));
    return static_cast<int>(std::clamp(std::round(4 + slope * (v - middle) + taste + noise), 1.0, 7.0));
  };
}

study::RivalData data_of(const std::filesystem::path& path, const std::string& question = "") {
  std::string mend;
  const auto study = study::read_tasks(path);
  const auto chosen = study::choose_rated_task(study, {study::TaskKind::Pilot, "", {}, question, {}}, mend);
  EXPECT_TRUE(chosen) << chosen.reason();
  return study::collect_rival_data(path, study, *chosen, {});
}

/// Two pilots of ten people each, who judge by the longest freeze or by the mean rate.
struct Pilots {
  TemporaryFolder folder;
  std::filesystem::path freezes = folder / "freezes.db", rates = folder / "rates.db";
  Pilots() {
    rival_study::write(freezes, 10, judging_by(TimingPredictor::Longest, 2.2, 2));
    rival_study::write(rates, 10, judging_by(TimingPredictor::MeanRate, 3.4, 2.5));
  }
};
const Pilots& pilots() {
  static const Pilots made;
  return made;
}

apps::test::Ended compare(const std::string& arguments) {
  return apps::test::run_shell(VIP_BIN_DIR "/vip-stats compare-models " + arguments);
}

TEST(CompareModels, ReadsAnswersWithTheirTiming) {
  const auto data = data_of(pilots().freezes);
  EXPECT_EQ(data.answers.n(), 210u);
  EXPECT_EQ(data.answers.people, 10);
  EXPECT_EQ(data.answers.choices, 7);
  EXPECT_EQ(data.settings.size(), 21u);
  EXPECT_TRUE(data.without_frames.empty());
  std::string mend;
  EXPECT_EQ(study::why_no_comparison(data, mend), "");
  for (std::size_t i = 0; i < data.answers.n(); ++i) {
    const auto& setting = data.settings[static_cast<std::size_t>(data.setting[i])];
    EXPECT_NEAR(data.timing[i][0], std::log(setting.mean), 1e-6);
    EXPECT_NEAR(data.timing[i][2], setting.sd, 1e-5);
  }
}

TEST(CompareModels, NamesTheModelOfPeopleWhoMindFreezes) {
  const auto data = data_of(pilots().freezes);
  const auto models = study::parse_timing_models("longest,mean_rate,hitches");
  stats::RivalComparisonOptions options;
  options.folds = 5;
  const auto result = study::compare_timing_models(data, models, options);
  ASSERT_TRUE(result) << result.reason();
  EXPECT_EQ(result->verdict, stats::RivalVerdict::Winner);
  const auto json = study::compare_models_json(data, models, options, *result);
  EXPECT_EQ(json.at("verdict").at("kind"), "winner");
  EXPECT_EQ(json.at("models")[0].at("name"), "longest");
  EXPECT_EQ(json.at("exploratory"), true);
  // Calibration: all answers, and predictions that agree with the answers within three standard errors.
  int answers = 0;
  for (const auto& bin : json.at("models")[0].at("calibration")) {
    answers += bin.at("answers").get<int>();
    if (bin.at("answers").get<int>() < 20) continue;
    EXPECT_NEAR(bin.at("predicted").get<double>(), bin.at("observed").get<double>(),
                3 * bin.at("se").get<double>());
  }
  EXPECT_EQ(answers, 210);
}

TEST(CompareModels, SaysThatItCannotTellANestedModelApart) {
  const auto data = data_of(pilots().rates);
  const auto models = study::parse_timing_models("ptpe,mean_rate,longest");
  stats::RivalComparisonOptions options;
  options.folds = 5;
  const auto result = study::compare_timing_models(data, models, options);
  ASSERT_TRUE(result) << result.reason();
  const auto json = study::compare_models_json(data, models, options, *result);
  EXPECT_EQ(json.at("verdict").at("kind"), "undecided");
  EXPECT_THAT(json.at("verdict").at("text").get<std::string>(), HasSubstr("ptpe contains mean_rate"));
  EXPECT_NEAR(json.at("models")[json.at("models")[0].at("name") == "ptpe" ? 0 : 1].at("b").get<double>(), 0,
              0.02);
}

TEST(CompareModelsSlow, AnimationErrorIsAModelWhereItIsRecorded) {
  const TemporaryFolder folder;
  const auto path = folder / "errors.db";
  rival_study::write(path, 8, judging_by(TimingPredictor::AnimationError, 2, -2), true,
                     [](int trial) { return 3.0 * (trial * 7 % 11); });
  const auto data = data_of(path);
  const auto models = study::parse_timing_models("animation_error,mean_rate");
  std::string mend;
  EXPECT_EQ(study::why_not_recorded(data, models, mend), "");
  stats::RivalComparisonOptions options;
  options.folds = 4;
  const auto result = study::compare_timing_models(data, models, options);
  ASSERT_TRUE(result) << result.reason();
  const auto json = study::compare_models_json(data, models, options, *result);
  EXPECT_EQ(json.at("models")[0].at("name"), "animation_error");
  EXPECT_FALSE(json.at("proposals").at("timings").empty());
}

TEST(CompareModels, ProposesTimingsThatAProtocolTakes) {
  const auto data = data_of(pilots().freezes);
  const auto models = study::parse_timing_models("longest,p95");
  stats::RivalComparisonOptions options;
  options.folds = 5;
  const auto result = study::compare_timing_models(data, models, options);
  ASSERT_TRUE(result) << result.reason();
  const auto json = study::compare_models_json(data, models, options, *result);
  const auto& timings = json.at("proposals").at("timings");
  ASSERT_GE(timings.size(), 3u);
  const auto hitches = base::read_file(base::resource("protocols/hitches.toml"), 1 << 20);
  const std::string line = "timing = {profile = \"moments\", mean_fps = 60}";
  ASSERT_THAT(hitches, HasSubstr(line));
  double before = HUGE_VAL;
  for (const auto& one : timings) {
    EXPECT_LE(one.at("information").get<double>(), before);
    before = one.at("information");
    auto text = hitches;
    text.replace(text.find(line), line.size(), one.at("timing").get<std::string>());
    EXPECT_NO_THROW(study::parse_protocol(text, "proposal.toml")) << one.at("timing");
  }
  EXPECT_GT(timings[0].at("information").get<double>(), 0.05) << "the models differ there";
}

TEST(CompareModelsE2e, PrintsWhatTheJsonHolds) {
  const std::string json_file = pilots().folder / "out.json";
  const auto ended =
      compare(pilots().freezes.string() + " --models longest,p95,mean_rate --folds 5 --json " + json_file);
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  for (const char* part : {"10 people, 210 answers to 21 timings", "exploratory: ", "longest", "nothing",
                           "calibration of longest", "timings at which"})
    EXPECT_THAT(ended.out, HasSubstr(part));
  const auto json = base::parse_json(base::read_file(json_file, 1 << 22));
  EXPECT_EQ(json.at("schema"), "vip-compare-models/1");
  EXPECT_THAT(ended.out, HasSubstr(json.at("verdict").at("text").get<std::string>()));
  EXPECT_EQ(json.at("models").size(), 5u) << "three models, nothing and free";
  EXPECT_EQ(json.at("folds"), 5);
}

TEST(CompareModels, APlanIsReadBackAndChecked) {
  const TemporaryFolder folder;
  const auto plan_of = [&](const std::string& text, const study::Protocol* protocol = nullptr) {
    base::write_file_atomically(folder / "plan.toml", text);
    return study::read_plan(folder / "plan.toml", protocol);
  };
  const std::string head = "format = 1\n[model_comparison]\nquestion = \"satisfaction\"\n";
  const auto plan = plan_of(head + "models = [\"p95\", \"longest+hitches\"]\n");
  const std::string text = study::format_plan(plan.plan, {"ab"});
  EXPECT_EQ(study::format_plan(plan_of(text).plan, {"ab"}), text);
  ASSERT_TRUE(plan_of(text).plan.comparison);
  EXPECT_EQ(plan_of(text).plan.comparison->models, (std::vector<std::string>{"p95", "longest+hitches"}));
  EXPECT_THAT(study::format_plan({}, {}), ::testing::Not(HasSubstr("model_comparison")));
  const auto pilot = study::read_protocol(base::resource("protocols/ptpe_pilot.toml"));
  const auto task2 = study::read_protocol(base::resource("protocols/task2.toml"));
  EXPECT_NO_THROW(plan_of(text, &pilot));
  const auto refused = [&](const std::string& wrong, const char* words,
                           const study::Protocol* protocol = nullptr) {
    EXPECT_THAT([&] { plan_of(wrong, protocol); }, ::testing::ThrowsMessage<base::Error>(HasSubstr(words)))
        << wrong;
  };
  refused(head + "models = [\"p95\", \"p96\"]\n", "models of [model_comparison]: 'p96' is no model");
  refused(head + "models = [\"p95\"]\n", "fewer than two models");
  refused(head + "models = [\"p95\", \"p99\"]\nexpected = \"longest\"\n", "is none of the models");
  refused(head + "models = [\"p95\", \"p99\"]\nfolds = 1\n", "leaves nobody to fit");
  refused(head + "models = [\"p95\", \"p99\"]\nmodel = \"x\"\n", "model");
  refused(text, "which shows pairs", &task2);
  refused("format = 1\n[model_comparison]\nquestion = \"joy\"\nmodels = [\"p95\", \"p99\"]\n",
          "names no rating", &pilot);
  refused(head + "models = [\"p95\", \"p99\"]\nfolds = 17\n", "is more than the 16 participants", &pilot);
  EXPECT_NO_THROW(plan_of(head + "models = [\"p95\", \"p99\"]\nfolds = 16\n", &pilot));
  refused(head + "models = [\"longest+p95\", \"p95+longest\"]\n",
          "'p95+longest' twice, the first time as 'longest+p95'");
  refused(head + "models = [\"ptpe\", \"rate_sd+mean_rate\"]\n", "the first time as 'ptpe'");
  refused(head.substr(head.find('[')) + "models = [\"p95\", \"p99\"]\n", "write format = 1");
}

TEST(CompareModels, TheExampleInTheDocsIsAPlan) {
  const TemporaryFolder folder;
  const std::string page = base::read_file(base::resource("docs/statistics.md"), 1 << 22);
  const auto table = page.find("[model_comparison]\nquestion");
  ASSERT_NE(table, std::string::npos);
  const auto begin = page.rfind("```toml\n", table) + 8;
  base::write_file_atomically(folder / "plan.toml", page.substr(begin, page.find("```", table) - begin));
  const auto pilot = study::read_protocol(base::resource("protocols/ptpe_pilot.toml"));
  EXPECT_EQ(study::read_plan(folder / "plan.toml", &pilot).plan.comparison->expected, "longest");
}

TEST(CompareModelsE2e, WhatThePlanDeclaresIsConfirmatoryAlsoIfThereIsNothingToPredict) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  rival_study::write(at("same.db"), 1, [](int, const TimingPredictors&) { return 4; });
  const auto same = compare(at("same.db"));
  EXPECT_EQ(same.exit_code, 1) << same.out;
  EXPECT_THAT(same.out,
              HasSubstr("all 21 answers are 4, so there is no difference that a model could predict"));
  EXPECT_THAT(same.out, ::testing::Not(HasSubstr("--models")));

  base::write_file_atomically(at("pilot.toml"), rival_study::protocol_text());
  base::write_file_atomically(at("plan.toml"),
                              "format = 1\n[model_comparison]\nquestion = \"satisfaction\"\nmodels = "
                              "[\"longest\", \"mean_rate\"]\nfolds = 2\nexpected = \"longest\"\n");
  const auto freeze = [&](const char* bundle) {
    study::report::BundleRequest request;
    request.protocols = {at("pilot.toml")};
    request.plan = study::read_plan(at("plan.toml")).plan;
    study::report::freeze_bundle(request, at(bundle));
  };
  freeze("before");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // times of answers are whole seconds
  rival_study::write(at("random.db"), 8, [](int person, const TimingPredictors& timing) {
    const auto count = static_cast<std::uint64_t>(std::llround(1e6 * (timing[0] + timing[2] + timing[6])));
    return 1 + static_cast<int>(7 * study::uniform_of(31 + static_cast<std::uint64_t>(person), count));
  });
  const auto compared = [&](const std::string& options) {
    const auto ended = compare(at("random.db") + options + " --json " + at("out.json"));
    EXPECT_EQ(ended.exit_code, 0) << ended.out;
    auto json = base::parse_json(base::read_file(at("out.json"), 1 << 22));
    json["out"] = ended.out;
    return json;
  };
  const auto frozen = compared(" --preregistered " + at("before"));
  EXPECT_EQ(frozen.at("exploratory"), false);
  EXPECT_EQ(frozen.at("models").size(), 4u) << "two models, nothing and free";
  EXPECT_EQ(frozen.at("folds"), 2);
  EXPECT_EQ(frozen.at("verdict").at("confirmed"), false);
  EXPECT_EQ(frozen.at("preregistration").at("preregistered"), true);
  EXPECT_THAT(
      frozen.at("out").get<std::string>(),
      HasSubstr("confirmatory: plan.toml declares this comparison and was frozen before the first answer"));
  const auto text = frozen.at("verdict").at("text").get<std::string>();
  EXPECT_THAT(text, HasSubstr("The plan expects longest: not confirmed"));
  EXPECT_THAT(
      text, HasSubstr("No model predicts the answers clearly better than the average answer (nothing) does"));
  const auto expect_exploratory = [&](const std::string& options, const std::string& reason) {
    const auto json = compared(options);
    EXPECT_EQ(json.at("exploratory"), true);
    EXPECT_FALSE(json.at("verdict").contains("confirmed"));
    EXPECT_THAT(json.at("out").get<std::string>(), HasSubstr("exploratory: plan.toml declares " + reason));
  };
  expect_exploratory(" --plan " + at("plan.toml"), "this comparison, but nothing shows that it is older");
  freeze("after");
  expect_exploratory(" --preregistered " + at("after"), "this comparison, but the bundle, frozen ");
  const auto plan = base::read_file(folder / "before/plan.toml", 1 << 16);
  base::write_file_atomically(folder / "before/plan.toml", plan + "# changed\n");
  expect_exploratory(" --preregistered " + at("before"), "this comparison, but files of the bundle were");
  const auto other = compared(" --plan " + at("plan.toml") + " --models p95,longest --seed 2");
  EXPECT_EQ(other.at("exploratory"), true);
  EXPECT_FALSE(other.at("verdict").contains("confirmed"));
  EXPECT_THAT(other.at("out").get<std::string>(),
              HasSubstr("exploratory: plan.toml declares other models and rules of exclusion or seed"));
}

TEST(CompareModelsE2e, RefusesWithRemedies) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const auto any = judging_by(TimingPredictor::MeanRate, 3.4, 2);
  rival_study::write(at("few.db"), 7, any);
  rival_study::write(at("bare.db"), 8, any, false);
  const auto expect_refused = [&](const std::string& arguments, const std::string& problem,
                                  const std::string& mend) {
    const auto ended = compare(arguments);
    EXPECT_EQ(ended.exit_code, 1) << arguments;
    EXPECT_THAT(ended.out, HasSubstr(problem)) << arguments;
    EXPECT_THAT(ended.out, HasSubstr(mend)) << arguments;
  };
  expect_refused(at("few.db"), "at least 8 people, not 7", "collect more participants");
  expect_refused(at("bare.db") + " --exclude none --json " + at("none.json"), "no comparison",
                 "which a session records");
  EXPECT_FALSE(std::filesystem::exists(at("none.json")));
  expect_refused(at("missing.db"), "missing.db", "");
  expect_refused(at("few.db") + " --models p95,p96", "'p96' is no model", "write names of ptpe");
  expect_refused(at("few.db") + " --question nothing", "no question 'nothing'", "--question: satisfaction");
  expect_refused(pilots().freezes.string() + " --models animation_error,p95",
                 "animation_error is not recorded for 210 of 210 answers",
                 "leave animation_error out of --models");
  expect_refused(pilots().freezes.string() + " --folds 11", "there are only 10 people", "leave it out");
  expect_refused(pilots().freezes.string() + " --folds 1", "leaves nobody to fit", "2 and more");
}

}  // namespace
