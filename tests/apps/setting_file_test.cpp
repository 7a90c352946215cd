/// best.toml: the setting that a sweep chose, for the programs that run it.
#include "libsim/setting/setting_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/error.hpp"
#include "tests/apps/measured_setting.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

sim::SettingFile example(sim::MethodKind method) {
  auto out = test::measured_setting(sim::usual_setting("SingleDam", method, 4096));
  out.setting[sim::SolverKnob::Iterations] = 6;
  out.setting[sim::SolverKnob::Momentum] = 0.1 + 0.2;
  out.measured.machine = "a \"quoted\" machine";
  out.measured.budget_ms = 11.1;
  out.measured.ms_mean = 1.0 / 3;
  return out;
}

TEST(SettingFile, ReadsBackToTheSameValues) {
  for (const auto& method : sim::all_methods()) {
    auto file = example(method.kind);
    if (sim::turns(sim::SolverKnob::Beta, method.kind)) file.setting[sim::SolverKnob::Beta] = 0.7866;
    const auto back = sim::parse_setting_file(sim::format_setting_file(file), "x");
    EXPECT_EQ(sim::to_text(back.setting), sim::to_text(file.setting));
    EXPECT_EQ(back.setting[sim::SolverKnob::Momentum], 0.1 + 0.2);
    EXPECT_EQ(back.measured.machine, file.measured.machine);
    EXPECT_EQ(back.measured.ms_mean, file.measured.ms_mean);
    EXPECT_EQ(sim::format_setting_file(back), sim::format_setting_file(file));
  }
}

TEST(SettingFile, HoldsTheMethodsOwnKnobsOnly) {
  EXPECT_THAT(sim::format_setting_file(example(sim::MethodKind::HiRes)), Not(HasSubstr("beta")));
  EXPECT_THAT(sim::format_setting_file(example(sim::MethodKind::Ours)), HasSubstr("\nbeta = 1\n"));
}

TEST(SettingFile, ErrorsNameThePlace) {
  const std::string sound = sim::format_setting_file(example(sim::MethodKind::Ours));
  const auto changed = [&](const std::string& from, const std::string& to) {
    auto text = sound;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  const auto refused = [](const std::string& text, const char* why) {
    EXPECT_THAT([&] { sim::parse_setting_file(text, "best.toml"); },
                ThrowsMessage<base::Error>(HasSubstr(why)));
  };
  refused("", "best.toml");
  refused(changed("format = 1", "format = 2"), "is not the format this program reads (1)");
  refused(changed("iterations = 6", "iterations = 0"), "iterations");
  refused(changed("iterations = 6", "iterations = 6.5"), "iterations");
  refused(changed("levels = 4", "levels = 5"), "levels");
  refused(changed("beta = 1", "beta = 0"), "beta");
  refused(changed("momentum", "momentun"), "momentum");
  refused(changed("\"Ours\"", "\"Theirs\""), "method");
  refused(changed("ms_p95 = 9.75", "ms_p95 = -1"), "ms_p95");
  refused(sound + "more = 1\n", "more");
}

TEST(SettingFile, SaysForWhichSceneAndWhetherPicturesWereTimed) {
  auto file = example(sim::MethodKind::HiRes);
  EXPECT_EQ(sim::other_scene(file, "feed"), "");
  EXPECT_THAT(sim::other_scene(file, "beef"), HasSubstr("another scene file"));
  EXPECT_THAT(sim::describe(file),
              HasSubstr("9.75 ms in 95 % of the frames (the solver alone), centre_pct 0.25 "
                        "[0.2, 0.3], measured on a \"quoted\" machine"));
  file.measured.picture = "640x360";
  EXPECT_THAT(sim::describe(file), HasSubstr("95 % of the frames with pictures"));
}

}  // namespace
}  // namespace apps
