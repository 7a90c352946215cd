/// vip-study run --setting: the cells that use the file's settings, refusals, and the record of the settings.
#include "libstudy/runner/session_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/runner/cell_stimuli.hpp"
#include "libstudy/runner/run_options.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/measured_setting.hpp"
#include "tests/apps/small_dam.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps {
namespace {

using test::replaced;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

/// A setting file for this method and n_*, with six projections.
std::string setting_text(sim::MethodKind method, std::int64_t n_star, double frames_per_s = 60) {
  auto out = test::measured_setting(sim::usual_setting("SingleDam", method, n_star));
  out.setting[sim::SolverKnob::Rate] = frames_per_s;
  out.setting[sim::SolverKnob::Iterations] = 6;
  out.setting[sim::SolverKnob::Beta] = 0.9;
  return sim::format_setting_file(out);
}

/// The pilot, which shows HiRes at 32k in steps of 1/60 s, with `from` replaced by `to`.
study::Protocol protocol_of(const std::string& from = "name", const std::string& to = "name") {
  return study::parse_protocol(replaced(test::short_protocol("1"), from, to), "short.toml",
                               study::ProtocolUse::New);
}

void refused(const std::vector<std::string>& texts, const char* why) {
  EXPECT_THAT([&] { study::SessionSettings(texts, protocol_of(), "best.toml"); },
              ThrowsMessage<base::Error>(AllOf(HasSubstr("best.toml"), HasSubstr(why))));
}

TEST(SessionSettings, HoldForTheCellsOfTheirMethodAndSize) {
  const std::string text = setting_text(sim::MethodKind::HiRes, 32 * 1024);
  const study::SessionSettings settings({text}, protocol_of(), "best.toml");
  const auto* file = settings.of({"any scene", "hires", "32k"});
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(file->setting[sim::SolverKnob::Iterations], 6);
  EXPECT_EQ(settings.of({"any scene", "LoRes", "32k"}), nullptr);
  EXPECT_EQ(settings.of({"any scene", "HiRes", "16k"}), nullptr);
  EXPECT_THAT(settings.description(), AllOf(HasSubstr(base::sha256_hex(text)), HasSubstr("iterations=6")));
  EXPECT_TRUE(study::SessionSettings().empty());
  EXPECT_EQ(study::SessionSettings().description(), "");
}

TEST(SessionSettings, WhatTheProtocolDoesNotShowIsRefused) {
  refused({setting_text(sim::MethodKind::Ours, 32 * 1024)}, "setting of Ours at n_* 32768, which no cell");
  refused({setting_text(sim::MethodKind::HiRes, 16 * 1024)}, "setting of HiRes at n_* 16384, which no cell");
  refused({setting_text(sim::MethodKind::HiRes, 32 * 1024, 90)}, "frames_per_s = 90");
  const std::string right = setting_text(sim::MethodKind::HiRes, 32 * 1024);
  refused({right, replaced(right, "iterations = 6", "iterations = 8")}, "second setting for HiRes");
  refused({"format = 1\n"}, "setting");
}

TEST(SessionSettings, NotesSayWhereTheFileIsFromAnotherScene) {
  const study::SessionSettings settings({setting_text(sim::MethodKind::HiRes, 32 * 1024)}, protocol_of(),
                                        "best.toml");
  const auto notes = settings.notes(protocol_of());
  ASSERT_THAT(notes, SizeIs(2));
  EXPECT_THAT(notes[0], HasSubstr("9.75 ms in 95 % of the frames"));
  EXPECT_THAT(notes[1], HasSubstr("another scene file"));
}

TEST(RunOptionsText, KeepsTheSettingsInFullAndNoticesAChange) {
  study::RunOptions options;
  options.clock = "real";
  options.settings = {setting_text(sim::MethodKind::HiRes, 4096), setting_text(sim::MethodKind::Ours, 4096)};
  const std::string text = study::format_run_options(options);
  EXPECT_EQ(study::parse_run_options(text, "a.db"), options);
  EXPECT_THAT([&] { study::parse_run_options(replaced(text, "iterations = 6", "iterations = 8"), "a.db"); },
              ThrowsMessage<base::Error>(HasSubstr("a.db")));
  options.settings.clear();
  EXPECT_THAT(study::format_run_options(options), Not(HasSubstr("settings")));
}

/// Two methods in a small scene that settles at once.
class SettingInStudy : public ::testing::Test {
 protected:
  SettingInStudy() {
    base::write_file_atomically(scene_, test::small_dam);
    base::write_file_atomically(
        protocol_, test::with_keys(test::short_protocol("0.5"), {{"scene", "[\"" + scene_ + "\"]"},
                                                                 {"mean_fps", "[20]"},
                                                                 {"sd_fps", "[0]"},
                                                                 {"method", "[\"LoRes\", \"Ours-TSp\"]"},
                                                                 {"n_star", "[\"64\"]"}}));
    base::write_file_atomically(setting_, text_);
  }
  test::Ended run(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"--participants", "1",       "--display", "headless", "--backend", "cpu",
                                 "--clock",        "virtual", "--size",    "64x36"};
    all.insert(all.end(), more.begin(), more.end());
    return test::run_program(test::run_arguments(protocol_, database_, all));
  }
  std::string text_of(const std::string& sql) const {
    study::sqlite::Connection connection(database_, study::sqlite::Open::Read);
    study::sqlite::Statement row(connection, sql);
    return row.step() ? row.text(0) : "";
  }

  test::TemporaryFolder folder_;
  std::string scene_ = folder_ / "dam.toml", protocol_ = folder_ / "short.toml";
  std::string database_ = folder_ / "study.db", setting_ = folder_ / "best.toml";
  std::string text_ = setting_text(sim::MethodKind::OursTsp, 64);
};

TEST_F(SettingInStudy, TheFluidOfItsCellsRunsAtItsNumbersAndThatOfOthersDoesNot) {
  study::RunOptions options;
  options.display = "headless";
  options.backend = "cpu";
  const auto protocol = study::read_protocol(protocol_);
  study::CellStimuli stimuli(options, protocol, {}, {}, {},
                             study::SessionSettings({text_}, protocol, "best.toml"));
  for (const auto& cell : protocol.design.cells) {
    auto& fluid = dynamic_cast<study::LiveFluid&>(stimuli.stimulus(cell));
    fluid.start(0);
    const bool its_own = cell.stimulus.method == "Ours-TSp";
    EXPECT_EQ(fluid.simulation().live_numbers().iterations, its_own ? 6 : 2) << cell.stimulus.method;
    EXPECT_EQ(fluid.description().find("iterations=6") != std::string::npos, its_own);
    EXPECT_EQ(stimuli.choice_of(cell).fixed_rate.has_value(), !its_own) << "tau follows from the file's beta";
  }
  EXPECT_THAT(stimuli.description(), HasSubstr(base::sha256_hex(text_)));
}

class SettingInStudyE2e : public SettingInStudy {};

TEST_F(SettingInStudyE2e, GoesFromTheFileToTheRecordToEveryExportAndToTheReport) {
  const auto ended = run({"--setting", setting_});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("9.75 ms in 95 % of the frames"), HasSubstr("another scene file"),
                               HasSubstr("tau follows its beta, 0.9")));
  const std::string sha256 = base::sha256_hex(text_), file = "setting_" + sha256.substr(0, 12) + ".toml";
  EXPECT_EQ(text_of("SELECT json_extract(options, '$.settings[0].text') FROM run"), text_);
  EXPECT_THAT(text_of("SELECT stimulus FROM session"), AllOf(HasSubstr(sha256), HasSubstr("iterations=6")));
  // tau follows from the file's beta, so no frame has measured moments of the frame rate.
  EXPECT_EQ(test::count_in(database_, "SELECT count(*) FROM frame WHERE mu_fps IS NOT NULL"), 0);
  EXPECT_GT(test::count_in(database_, "SELECT count(*) FROM frame WHERE beta BETWEEN 0.8999 AND 0.9001"), 0);

  const auto exported = [&](const std::string& kind) {
    const std::string out = folder_ / kind.substr(2);
    const auto done = test::run_program({test::vip_study, "export", "--db", database_, kind, out});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return out + "/";
  };
  const std::string csv = exported("--csv"), bids = exported("--bids"), psych = exported("--psych-ds");
  EXPECT_EQ(base::read_file(csv + file, 1 << 20), text_);
  EXPECT_EQ(base::read_file(bids + "code/" + file, 1 << 20), text_);
  EXPECT_EQ(base::read_file(psych + "materials/" + file, 1 << 20), text_);
  for (const auto& table : {csv + "sessions.csv", csv + "ratings.csv", bids + "sub-P01/sub-P01_sessions.tsv"})
    EXPECT_THAT(base::read_file(table, 1 << 20), AllOf(HasSubstr("setting_sha256"), HasSubstr(sha256)))
        << table;
  EXPECT_THAT(base::read_file(psych + "dataset_description.json", 1 << 20), HasSubstr("setting_sha256"));

  const auto sessions = study::read_tasks(database_).protocols.at(0).sessions;
  ASSERT_THAT(sessions, SizeIs(1));
  ASSERT_THAT(sessions[0].settings, SizeIs(1));
  EXPECT_EQ(sessions[0].settings[0].text, text_);
}

TEST_F(SettingInStudyE2e, WithoutOneNothingIsSaid) {
  ASSERT_EQ(run({}).exit_code, 0);
  EXPECT_THAT(text_of("SELECT options FROM run"), Not(HasSubstr("settings")));
  EXPECT_THAT(text_of("SELECT stimulus FROM session"), Not(HasSubstr("setting")));
  EXPECT_TRUE(study::read_tasks(database_).protocols.at(0).sessions.at(0).settings.empty());
  const std::string csv = folder_ / "csv";
  ASSERT_EQ(test::run_program({test::vip_study, "export", "--db", database_, "--csv", csv}).exit_code, 0);
  for (const auto& entry : test::fs::directory_iterator(csv))
    EXPECT_THAT(entry.path().filename().string(), Not(::testing::StartsWith("setting_")));
}

TEST_F(SettingInStudyE2e, ResumeTakesTheRecordedSettingAndNoOther) {
  std::vector<std::string> all{"--participants", "1",       "--display", "headless", "--backend", "cpu",
                               "--clock",        "virtual", "--size",    "64x36",    "--setting", setting_};
  test::Process stopped(test::run_arguments(protocol_, database_, all));
  for (auto line = stopped.read_line(); line && line->find(" stimulus ") == std::string::npos;)
    line = stopped.read_line();
  stopped.send(SIGINT);
  stopped.wait();
  ASSERT_GT(test::count_in(database_, "SELECT count(*) FROM unit WHERE state = 'planned'"), 0)
      << "it ended before it was stopped";
  test::fs::remove(setting_);
  const std::string other = folder_ / "other.toml";
  base::write_file_atomically(other, replaced(text_, "iterations = 6", "iterations = 8"));
  const auto refused = test::run_program({test::vip_study, "resume", "--db", database_, "--setting", other});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("is not a setting with which the sessions of"),
                                 HasSubstr(base::sha256_hex(text_).substr(0, 12))));
  const auto resumed = test::run_program({test::vip_study, "resume", "--db", database_});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(test::count_in(database_, "SELECT count(*) FROM unit WHERE state = 'planned'"), 0);
  EXPECT_EQ(test::count_in(database_, "SELECT count(*) FROM frame WHERE mu_fps IS NOT NULL"), 0);
}

TEST_F(SettingInStudyE2e, WhatIsNotComputedLiveHasNoSetting) {
  const auto nothing = test::run_program(test::run_arguments(
      protocol_, database_, {"--participants", "1", "--display", "none", "--setting", setting_}));
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.err, HasSubstr("with --display none nothing is computed"));
  const std::string bake = folder_ / "dam.bake";
  const auto baked = test::run_program({test::vip_study, "bake", scene_, "--out", bake, "--method", "LoRes",
                                        "--n-star", "64", "--frames", "60", "--backend", "cpu"});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  test::replace_in(protocol_, ", \"Ours-TSp\"]", "]");
  base::write_file_atomically(setting_, setting_text(sim::MethodKind::LoRes, 64));
  const auto played = run({"--stimulus", bake, "--setting", setting_});
  EXPECT_EQ(played.exit_code, 1);
  EXPECT_THAT(played.err, HasSubstr("a bake holds the setting that it was computed at"));
  EXPECT_FALSE(test::fs::exists(database_));
  EXPECT_EQ(run({"--stimulus", bake}).exit_code, 0) << "the bake itself fits";
}

TEST_F(SettingInStudyE2e, ABadFileIsOneErrorThatNamesItAndWritesNothing) {
  for (const auto& [text, why] : {std::pair{std::string("format = 1\n"), "best.toml"},
                                  {replaced(text_, "iterations = 6", "iterations = 0"), "iterations"},
                                  {setting_text(sim::MethodKind::HiRes, 64), "which no cell of protocol"}}) {
    base::write_file_atomically(setting_, text);
    const auto ended = run({"--setting", setting_});
    EXPECT_EQ(ended.exit_code, 1);
    EXPECT_THAT(ended.err, AllOf(HasSubstr("best.toml"), HasSubstr(why)));
    EXPECT_FALSE(test::fs::exists(database_));
  }
}

}  // namespace
}  // namespace apps
