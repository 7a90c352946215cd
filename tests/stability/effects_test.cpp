/// Hard cases in water with the effects of each demo scene that lists some.

#include <gtest/gtest.h>

#include "libsim/cases/hard_case.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/stability/demo_scenes.hpp"

namespace {

using sim::cases::Setting;

constexpr std::size_t cases_count = 3;

/// Runs the case with the effects of every `step`-th scene, starting with scene `first`.
void runs(const char* id, const Setting& plain, std::size_t first = 0, std::size_t step = 1) {
  NEEDS_EFFECTS;
  const auto scenes = stability_test::scenes_with_effects();
  ASSERT_GE(scenes.size(), cases_count);
  for (std::size_t i = first; i < scenes.size(); i += step) {
    const sim::Scene& scene = scenes[i];
    Setting setting = plain;
    setting.effects = scene.effects;
    const auto outcome = sim::cases::hard_case(id).run(setting);
    std::printf("%s, %s, effects of %s: %s\n", id, sim::method_name(setting.method).c_str(),
                scene.name.c_str(), outcome.text().c_str());
    EXPECT_FALSE(outcome.stopped) << scene.name << ": " << outcome.text();
    const auto kept = of_stability(outcome);
    EXPECT_FALSE(kept.findings.empty());
    EXPECT_TRUE(kept.passes()) << scene.name << ": " << outcome.text();
  }
}

class EffectsCases : public testing::TestWithParam<std::tuple<const char*, sim::MethodKind>> {};
class EffectsCasesSlow : public EffectsCases {};
class EffectsCasesGpu : public EffectsCases {};

/// Each case and method runs with the effects of a third of the scenes: together they use every scene three
/// times. All scenes with each case and method take minutes, in the slow suite.
TEST_P(EffectsCases, StayStable) {
  const auto [id, method] = GetParam();
  const std::string name = id;
  const std::size_t of_case = name == "S1" ? 0 : name == "S9" ? 1 : 2;
  const std::size_t of_method = method == sim::MethodKind::HiRes   ? 0
                                : method == sim::MethodKind::LoRes ? 1
                                                                   : 2;
  runs(id, {.method = method}, (of_case + of_method) % 3, 3);
}
TEST_P(EffectsCasesSlow, StayStable) {
  const auto [id, method] = GetParam();
  runs(id, {.method = method});
}
TEST_P(EffectsCasesGpu, StayStable) {
  const auto [id, method] = GetParam();
  runs(id, {.method = method, .backend = sim::Backend::Cuda});
}

std::string name_of(const testing::TestParamInfo<EffectsCases::ParamType>& info) {
  std::string out = std::string(std::get<0>(info.param)) + sim::method_name(std::get<1>(info.param));
  std::erase(out, '-');
  return out;
}
const auto cases = testing::Combine(
    testing::Values("S1", "S9", "S11"),
    testing::Values(sim::MethodKind::HiRes, sim::MethodKind::LoRes, sim::MethodKind::OursTsp));
INSTANTIATE_TEST_SUITE_P(OfScenes, EffectsCases, cases, name_of);
INSTANTIATE_TEST_SUITE_P(OfScenes, EffectsCasesSlow, cases, name_of);
INSTANTIATE_TEST_SUITE_P(OfScenes, EffectsCasesGpu, cases, name_of);

}  // namespace
