/// Solver settings and frame costs, from a session's record to its readers.
#include "libstudy/store/read/run_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/read/frame_costs.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr const char* text_a = "format = 1\n# a, \"quoted\"\n";
constexpr const char* text_b = "format = 1\n# b\n";

std::string options_with(const std::vector<std::string>& texts) {
  std::string list;
  for (std::string text : texts) {
    const std::string sha256 = base::sha256_hex(text);
    for (auto at = text.find_first_of("\n\""); at != std::string::npos;
         at = text.find_first_of("\n\"", at + 2))
      text.replace(at, 1, text[at] == '"' ? "\\\"" : "\\n");
    list +=
        (list.empty() ? "" : ",") + std::string(R"({"sha256":")") + sha256 + R"(","text":")" + text + "\"}";
  }
  return R"({"format":2,"settings":[)" + list + "]}";
}

class RunSettings : public ::testing::Test {
 protected:
  std::filesystem::path study_with(const std::string& options) {
    const auto path = folder_ / (std::to_string(++studies_) + ".db");
    RunPlan run = test::run_plan(test::pairs(), {"P1", "P2"});
    run.options = options;
    Store(path, sqlite::Open::Create).add_run(run);
    return path;
  }
  test::TemporaryFolder folder_;
  int studies_ = 0;
};

TEST_F(RunSettings, StandInTheSessionsTableAndAsFilesOfTheCsvExport) {
  const auto path = study_with(options_with({text_a, text_b}));
  export_csv(path, folder_ / "csv", {});
  const std::string sessions = test::bytes_of(folder_ / "csv" / "sessions.csv");
  EXPECT_THAT(sessions, AllOf(HasSubstr("setting_sha256"),
                              HasSubstr(base::sha256_hex(text_a) + " " + base::sha256_hex(text_b))));
  EXPECT_THAT(test::bytes_of(folder_ / "csv" / "dictionary.csv"),
              HasSubstr("sessions.csv,setting_sha256,TEXT,"));
  for (const char* text : {text_a, text_b})
    EXPECT_EQ(test::bytes_of(folder_ / "csv" / ("setting_" + base::sha256_hex(text).substr(0, 12) + ".toml")),
              text);
  // An export with settings files is recognised as an export, so another export may replace it.
  export_csv(study_with("{}"), folder_ / "csv", {});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "csv" /
                                       ("setting_" + base::sha256_hex(text_a).substr(0, 12) + ".toml")));
}

TEST_F(RunSettings, AreReadForEachSession) {
  const auto tasks = read_tasks(study_with(options_with({text_a})));
  for (const auto& session : tasks.protocols.at(0).sessions) {
    ASSERT_THAT(session.settings, SizeIs(1));
    EXPECT_EQ(session.settings[0].text, text_a);
    EXPECT_EQ(session.settings[0].sha256, base::sha256_hex(text_a));
    EXPECT_EQ(session.stimulus, "none");
  }
}

// Options of an earlier version or another program have no settings, which is no error.
TEST_F(RunSettings, OptionsWithoutAnyHaveNone) {
  for (const char* options : {"{}", "no json", "[]", R"({"settings":[]})"}) {
    const auto path = study_with(options);
    EXPECT_THAT(read_tasks(path).protocols.at(0).sessions.at(0).settings, IsEmpty()) << options;
    export_csv(path, folder_ / ("csv" + std::to_string(studies_)), {});
  }
}

TEST_F(RunSettings, TheLastCostsOfASessionAreReadAndDamagedOnesAreAnError) {
  const auto path = study_with("{}");
  const std::vector<FrameCosts> first{{{"a.toml", "HiRes", "32k"}, 4.5, 6}},
      last{{{"a.toml", "Ours", "32k", "", "spheres"}, 2, 3}};
  const auto session = [&] { return read_tasks(path).protocols.at(0).sessions.at(0); };
  const auto log = [&](const std::string& detail) {
    Store store(path, sqlite::Open::Write);
    store.log(store.open_runs().at(0).sessions.at(0).id, frame_costs_event, detail);
  };
  EXPECT_THAT(session().frame_costs, IsEmpty());
  log(format_frame_costs(first));
  log(format_frame_costs(last));
  EXPECT_EQ(session().frame_costs, last);
  EXPECT_THAT(read_tasks(path).protocols.at(0).sessions.at(1).frame_costs, IsEmpty());
  for (const char* damaged : {"{", "[{\"scene\":1}]",
                              "[{\"scene\":\"a\",\"method\":\"b\",\"n_star\":\"1\","
                              "\"mean_ms\":-1,\"p95_ms\":2}]"}) {
    log(damaged);
    EXPECT_THAT([&] { session(); }, ThrowsMessage<base::Error>(HasSubstr("frame costs"))) << damaged;
  }
}

}  // namespace
}  // namespace study
