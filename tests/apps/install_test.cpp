/// The programs after cmake --install: everything that they need at run time is installed with them. An
/// installed program looks nowhere else (base::resource), so a file missing in the install rules is an error
/// here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class InstallE2e : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const std::string log = *folder_ / "install.log";
    const std::string command = "cmake --install '" VIP_BIN_DIR "/..' --prefix '" +
                                (*folder_ / "prefix").string() + "' >'" + log + "' 2>&1";
    installed_ = std::system(command.c_str()) == 0;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { ASSERT_TRUE(installed_) << base::read_file(*folder_ / "install.log", 1 << 20); }

  /// Runs in the root folder, where no relative path leads into a source tree.
  static Ended run(std::vector<std::string> arguments) {
    arguments[0] = *folder_ / ("prefix/bin/" + arguments[0]);
    return run_program(arguments, [] {
      if (::chdir("/") != 0 || ::unsetenv("VIP_SHARE_DIR") != 0) ::_exit(125);
    });
  }
  static std::string at(const std::string& name) { return *folder_ / name; }

  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline bool installed_ = false;
};

TEST_F(InstallE2e, StudyFindsProtocolAndSchema) {
  const Ended checked = run({"vip-study", "check", "protocols/ptpe_pilot.toml", "--refresh", "90"});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  const Ended played = run({"vip-study", "run", "ptpe_pilot", "--db", at("study.db"), "--participants", "1",
                            "--observer", "ptpe:a=24,b=0.02"});
  EXPECT_EQ(played.exit_code, 0) << played.err;
  EXPECT_EQ(answers_in(at("study.db")).size(), 22u);  // 21 ratings and the consent
}

TEST_F(InstallE2e, AProtocolIsFoundByItsName) {
  const Ended frozen = run({"vip-stats", "preregister", "task1", "task2", "--out", at("bundle")});
  EXPECT_EQ(frozen.exit_code, 0) << frozen.err;
  const Ended unknown = run({"vip-study", "check", "ptpe_pilt"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("the nearest is \"ptpe_pilot\""));
}

/// bash's completions after these words, the last of which is incomplete.
std::string offered_after(const fs::path& prefix, const std::string& words) {
  const std::string script = "export PATH='" + (prefix / "bin").string() + "':$PATH; cd /; . '" +
                             (prefix / "share/bash-completion/completions/vip-study").string() +
                             "'; COMP_WORDS=(" + words +
                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); "
                             "_vip_lab ${COMP_WORDS[0]}; echo \" ${COMPREPLY[*]} \"";
  const Ended ended = run_program({"/bin/bash", "-c", script});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  return ended.out;
}

TEST_F(InstallE2e, BashCompletesCommandsOptionsChoicesAndProtocols) {
  const fs::path prefix = at("prefix");
  EXPECT_THAT(offered_after(prefix, "vip-study ''"), AllOf(HasSubstr(" run "), HasSubstr(" salvage ")));
  EXPECT_THAT(offered_after(prefix, "vip-study run --part"), HasSubstr(" --participants --participant "));
  EXPECT_EQ(offered_after(prefix, "vip-study run x --clock ''"), " real virtual \n");
  EXPECT_EQ(offered_after(prefix, "vip-study run ptpe_pilot_"), " ptpe_pilot_lab \n");
  EXPECT_EQ(offered_after(prefix, "vip-study bake --protocol foam_"), " foam_worth \n");
  EXPECT_THAT(offered_after(prefix, "vip-view --head"), HasSubstr(" --headless "));
}

TEST_F(InstallE2e, EveryCommandHasAManualPageAndTheLicencesAreThere) {
  const fs::path pages = at("prefix/share/man/man1");
  for (const char* name :
       {"vip-study", "vip-study-run", "vip-stats-fit-ptpe", "vip-bench-table1", "vip-view"}) {
    const Ended page = run_program({"/bin/gzip", "-dc", (pages / (std::string(name) + ".1.gz")).string()});
    EXPECT_EQ(page.exit_code, 0) << page.err;
    for (const char* part :
         {".TH \"VIP\\-", ".SH NAME", ".SH SYNOPSIS", ".SH OPTIONS\n.TP\n.B \\-h,\\-\\-help"})
      EXPECT_THAT(page.out, HasSubstr(part)) << name;
  }
  EXPECT_THAT(base::read_file(at("prefix/share/doc/vip-lab/copyright"), 1 << 20), HasSubstr("MIT License"));
}

TEST_F(InstallE2e, ViewFindsSceneAndShaders) {
  const Ended ended = run({"vip-view", "--headless", "data/scenes/single_dam.toml", "--n-star", "64",
                           "--backend", "cpu", "--frames", "1", "--size", "64x36", "--png", at("pictures")});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_TRUE(fs::exists(at("pictures/frame_0000.png")));
}

TEST_F(InstallE2e, BenchAndStatsStart) {
  const Ended bench = run({"vip-bench", "frame", "data/scenes/martin_moyce.toml", "--n-star", "64",
                           "--backend", "cpu", "--frames", "1", "--warm-up", "0", "--size", "64x36"});
  EXPECT_EQ(bench.exit_code, 0) << bench.err;
  const Ended peers = run({"vip-bench", "frame", "--peers", "--backend", "cpu", "--frames", "1"});
  EXPECT_EQ(peers.exit_code, 0) << peers.err;
  EXPECT_EQ(run({"vip-stats", "--version"}).exit_code, 0);
}

TEST_F(InstallE2e, AMissingFileIsNamedAndNotTakenFromASourceTree) {
  const fs::path shader = at("prefix/share/vip-lab/shaders/splat.comp");
  fs::rename(shader, at("splat.comp"));
  const Ended ended = run({"vip-view", "--headless", "data/scenes/single_dam.toml", "--n-star", "64",
                           "--backend", "cpu", "--frames", "1", "--png", at("none")});
  fs::rename(at("splat.comp"), shader);
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr(shader.string()));
}

}  // namespace

}  // namespace apps::test
