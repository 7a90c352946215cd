/// How often the comparison of timing models names the model by which simulated people judge, and what it
/// says where none of the models is theirs. docs/statistics.md has the printed shares. VIP_STUDIES sets the
/// number of studies.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "libstudy/analysis/rivals/compare_models.hpp"
#include "libstudy/pacing/schedule.hpp"

namespace {

using stats::RivalVerdict;
using study::FpsSetting;
using study::TimingPredictors;

/// A timing that is shown, with its predictors and its frame times.
struct Shown {
  FpsSetting setting;
  std::vector<double> intervals_s;
  TimingPredictors timing{};
};

Shown shown(const FpsSetting& setting) {
  Shown out{setting, study::compile_schedule(setting, {}, 1).intervals_s, {}};
  out.timing = study::timing_predictors(out.intervals_s);
  return out;
}

/// The paper's 21 settings under white pacing.
std::vector<Shown> papers_settings() {
  std::vector<Shown> out;
  for (const double mu : {10.0, 20.0, 30.0, 40.0, 50.0})
    for (const double delta : {0.0, 5.0, 10.0, 15.0, 20.0})
      if (delta < mu) out.push_back(shown({mu, delta, 10}));
  return out;
}

/// The same, and timings of the kinds that vip-stats compare-models proposes.
std::vector<Shown> with_proposals() {
  auto out = papers_settings();
  for (const auto& [fps, hitch_ms, period_s] :
       {std::array{50.0, 240.0, 1.0}, {50.0, 150.0, 0.5}, {30.0, 240.0, 5.0}, {20.0, 240.0, 1.0}})
    out.push_back(shown(study::setting_of(
        {.kind = study::ProfileKind::Hitches, .mean_fps = fps, .hitch_ms = hitch_ms, .period_s = period_s},
        10)));
  for (const auto& [slow, fast] : {std::array{8.0, 50.0}, {10.0, 30.0}, {5.0, 80.0}}) {
    study::TimingProfile profile{.kind = study::ProfileKind::Trace};
    for (const double fps : {slow, fast})
      profile.frame_ms.insert(profile.frame_ms.end(), static_cast<std::size_t>(fps / 2), 1000 / fps);
    out.push_back(shown(study::setting_of(profile, 10)));
  }
  for (const auto& [mean, low] : {std::array{40.0, 6.0}, {25.0, 5.0}})
    out.push_back(
        shown(study::setting_of({.kind = study::ProfileKind::Floor, .mean_fps = mean, .low_fps = low}, 10)));
  return out;
}

/// What a person goes by: larger is better. Any unit.
using Judge = std::function<double(const Shown&)>;

Judge judge_of(const study::TimingModel& model) {
  return [model](const Shown& one) {
    const double x = model.value(one.timing, 0);
    if (model.predictors.size() > 1) return x - 0.02 * model.value(one.timing, 1);
    const bool worse = model.name == "hitches" || model.name == "frame_time_sd";
    return worse ? -x : x;
  };
}

/// Share of the time in which the picture stands still for longer than 80 ms. No model has it.
double without_stalls(const Shown& one) {
  double all = 0, stalled = 0;
  for (const double dt : one.intervals_s) {
    all += dt;
    stalled += dt > 0.08 ? dt : 0;
  }
  return -std::sqrt(stalled / all);
}

/// Half of the mean rate and half of the longest freeze. No model has it.
double rate_and_freeze(const Shown& one) {
  return one.timing[static_cast<std::size_t>(study::TimingPredictor::MeanRate)] +
         0.8 * one.timing[static_cast<std::size_t>(study::TimingPredictor::Longest)];
}

/// 7-point ratings: 4 + 1.4 z + person + noise, rounded, with 2 % guesses; z is the standardised judgement,
/// persons differ with an SD of 0.5, the noise has an SD of 1.
study::RivalData study_of(const std::vector<Shown>& settings, const Judge& judge, int people,
                          std::uint64_t seed) {
  std::vector<double> z;
  double mean = 0, squares = 0;
  for (const Shown& one : settings) z.push_back(judge(one));
  for (const double v : z) mean += v / static_cast<double>(z.size());
  for (const double v : z) squares += (v - mean) * (v - mean) / static_cast<double>(z.size());
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  study::RivalData out;
  out.task.question.scale_min = 1;
  out.task.question.scale_max = 7;
  out.answers.people = people;
  for (int p = 0; p < people; ++p) {
    out.participants.push_back("P" + std::to_string(p));
    const double person = 0.5 * normal(engine);
    for (std::size_t s = 0; s < settings.size(); ++s) {
      const double x = 4 + 1.4 * (z[s] - mean) / std::sqrt(squares) + person + normal(engine);
      int score = static_cast<int>(std::clamp(std::round(x), 1.0, 7.0)) - 1;
      if (uniform(engine) < 0.02) score = static_cast<int>(7 * uniform(engine));
      out.answers.score.push_back(score);
      out.answers.person.push_back(p);
      out.setting.push_back(static_cast<int>(s));
      out.timing.push_back(settings[s].timing);
    }
  }
  for (const Shown& one : settings) out.settings.push_back(one.setting);
  return out;
}

struct Shares {
  double right = 0, wrong = 0, undecided = 0, none_fits = 0;
  double held = 0;  ///< the truth is in the running
};

/// `truth`: name of the model by which people judge; empty: of none.
Shares shares_of(const std::vector<Shown>& settings, const Judge& judge, const std::string& truth,
                 const std::vector<study::TimingModel>& models, int studies) {
  Shares out;
  const double part = 1.0 / studies;
  for (int s = 0; s < studies; ++s) {
    const auto data = study_of(settings, judge, 24, static_cast<std::uint64_t>(s) + 1);
    const auto result = study::compare_timing_models(data, models, {});
    if (!result) {
      ADD_FAILURE() << truth << s << ": " << result.reason();
      continue;
    }
    bool held = false;
    for (const int m : result->in_the_running)
      held = held || result->models[static_cast<std::size_t>(m)].name == truth;
    out.held += held ? part : 0;
    const auto& best = result->models[static_cast<std::size_t>(result->in_the_running.front())].name;
    if (result->verdict == RivalVerdict::Undecided) out.undecided += part;
    if (result->verdict == RivalVerdict::NoneFits) out.none_fits += part;
    if (result->verdict == RivalVerdict::Winner) (best == truth ? out.right : out.wrong) += part;
  }
  return out;
}

void print(const char* settings, const std::string& judge, const Shares& s) {
  std::printf("| %s | %s | %.2f | %.2f | %.2f | %.2f | %.2f |\n", settings, judge.c_str(), s.right, s.wrong,
              s.undecided, s.none_fits, s.held);
  std::fflush(stdout);
}

int studies() {
  const char* given = std::getenv("VIP_STUDIES");
  return given ? std::atoi(given) : 50;
}

/// Which timings are shown, and by what people judge.
struct RecoveryCase {
  bool proposals = false;  ///< with_proposals() instead of papers_settings()
  std::string judge;
};

std::vector<RecoveryCase> recovery_cases() {
  std::vector<RecoveryCase> out;
  for (const bool proposals : {false, true}) {
    for (const auto& model : study::usual_timing_models()) out.push_back({proposals, model.name});
    for (const char* judge : {"stalls", "rate and freeze"}) out.push_back({proposals, judge});
  }
  return out;
}

class RivalRecoverySlow : public testing::TestWithParam<RecoveryCase> {};

TEST_P(RivalRecoverySlow, NoOtherModelThanTheTruthIsNamed) {
  const auto& [proposals, name] = GetParam();
  const auto settings = proposals ? with_proposals() : papers_settings();
  const auto models = study::usual_timing_models();
  const auto model = std::find_if(models.begin(), models.end(),
                                  [&](const auto& one) { return one.name == GetParam().judge; });
  const bool is_model = model != models.end();
  const Judge judge = is_model ? judge_of(*model) : name == "stalls" ? without_stalls : rate_and_freeze;
  const auto found = shares_of(settings, judge, is_model ? name : "", models, studies());
  std::printf("| settings | judge | right | wrong | undecided | none fits | truth in the running |\n");
  print(proposals ? "30" : "21", name, found);
  EXPECT_LE(found.wrong, is_model ? 0.05 : 0.1);
  EXPECT_TRUE(!is_model || found.held >= 0.9) << found.held;
}

std::string case_name(const testing::TestParamInfo<RecoveryCase>& of) {
  std::string name = of.param.judge + (of.param.proposals ? "_30" : "_21");
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Of, RivalRecoverySlow, testing::ValuesIn(recovery_cases()), case_name);

TEST(RivalRecovery, TheTruthIsInTheRunningInOneStudyOfEach) {
  const auto settings = with_proposals();
  std::vector<Shown> some;
  for (std::size_t i = 0; i < settings.size(); i += 2) some.push_back(settings[i]);
  const auto models = study::parse_timing_models("ptpe,p95,frame_time_sd,longest");
  for (const auto& model : models) {
    const auto data = study_of(some, judge_of(model), 10, 3);
    stats::RivalComparisonOptions options;
    options.folds = 5;
    const auto result = study::compare_timing_models(data, models, options);
    ASSERT_TRUE(result) << result.reason();
    const int best = result->in_the_running.front();
    EXPECT_EQ(result->models[static_cast<std::size_t>(best)].name, model.name);
    EXPECT_NE(result->verdict, RivalVerdict::NoneFits) << model.name;
  }
}

}  // namespace
