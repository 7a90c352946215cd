/// What every program does alike: help, version, wrong command lines, the choice of a back end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Arguments = std::vector<std::string>;

const Arguments programs{"vip-study", "vip-stats", "vip-bench", "vip-view"};

std::string path_of(const std::string& program) { return VIP_BIN_DIR "/" + program; }

TEST(ProgramsE2e, HelpAndVersionSucceed) {
  for (const std::string& program : programs) {
    const Ended help = run_program({path_of(program), "--help"});
    EXPECT_EQ(help.exit_code, 0) << program;
    EXPECT_THAT(help.out, AllOf(HasSubstr("Usage: " + program), HasSubstr("--version"))) << program;
    const Ended version = run_program({path_of(program), "--version"});
    EXPECT_EQ(version.exit_code, 0) << program;
    EXPECT_EQ(version.out, base::version() + "\n") << program;
  }
}

TEST(ProgramsE2e, EveryCommandHasHelp) {
  const std::vector<Arguments> commands{
      {"vip-study", "check"},  {"vip-study", "bake"},   {"vip-study", "run"},      {"vip-study", "resume"},
      {"vip-study", "status"}, {"vip-study", "export"}, {"vip-stats", "fit-ptpe"}, {"vip-bench", "frame"}};
  for (const Arguments& command : commands) {
    const Ended help = run_program({path_of(command[0]), command[1], "--help"});
    EXPECT_EQ(help.exit_code, 0) << command[1];
    EXPECT_THAT(help.out, AllOf(HasSubstr(command[1]), HasSubstr("Options:"))) << command[1];
  }
}

TEST(ProgramsE2e, AWrongCommandLineEndsWithTwo) {
  for (const std::string& program : programs) {
    const Ended option = run_program({path_of(program), "--no-such-option"});
    EXPECT_EQ(option.exit_code, 2) << program;
    EXPECT_THAT(option.err, HasSubstr("--help")) << program;
    if (program == "vip-view") continue;  // has no commands
    const Ended command = run_program({path_of(program), "no-such-command"});
    EXPECT_EQ(command.exit_code, 2) << program;
    EXPECT_THAT(command.err, HasSubstr("no-such-command")) << program;
  }
}

TEST(ProgramsE2e, AMissingCommandShowsTheHelpAndEndsWithTwo) {
  for (const std::string program : {"vip-study", "vip-stats", "vip-bench"}) {
    const Ended ended = run_program({path_of(program)});
    EXPECT_EQ(ended.exit_code, 2) << program;
    EXPECT_THAT(ended.err, HasSubstr("Usage: " + program));
  }
}

/// No driver is needed, or no device is to be seen: the same to a program.
void hide_devices() { ::setenv("CUDA_VISIBLE_DEVICES", "", 1); }

class BackendE2e : public ::testing::Test {
 protected:
  BackendE2e() {
    const std::string scene = base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20);
    base::write_file_atomically(scene_, replaced(scene, "settle_frames = 120", "settle_frames = 1"));
  }
  /// Every command that computes fluid, with this back end.
  std::vector<Arguments> commands(const std::string& backend) const {
    const Arguments fluid{"--method", "LoRes", "--n-star", "64", "--backend", backend, "--frames", "2"};
    std::vector<Arguments> all{{path_of("vip-bench"), "frame", scene_, "--json", folder_ / "frame.json"},
                               {path_of("vip-study"), "bake", scene_, "--out", folder_ / "dam.bake"},
                               {path_of("vip-view"), "--headless", scene_, "--size", "64x48"}};
    for (Arguments& command : all) command.insert(command.end(), fluid.begin(), fluid.end());
    return all;
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "dam.toml";
};

TEST_F(BackendE2e, AutoWithoutADriverTakesTheCpu) {
  for (const Arguments& command : commands("auto")) {
    const Ended ended = run_program(command, hide_devices);
    EXPECT_EQ(ended.exit_code, 0) << command[0] << ended.err;
    if (command[1] != "bake") {
      EXPECT_THAT(ended.out, HasSubstr("on cpu")) << command[0];
    }
  }
}

TEST_F(BackendE2e, CudaWithoutADriverIsAClearError) {
  for (const Arguments& command : commands("cuda")) {
    const Ended ended = run_program(command, hide_devices);
    EXPECT_EQ(ended.exit_code, 1) << command[0];
    EXPECT_THAT(ended.err, AllOf(HasSubstr("--backend cuda"), HasSubstr("mend: use --backend cpu or auto")));
  }
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_.path())) ++files;
  EXPECT_EQ(files, 1u) << "something was written beside the scene";
}

TEST_F(BackendE2e, ABuildWithoutWindowsNamesHeadless) {
  const Ended ended =
      run_program({path_of("vip-view-no-window"), scene_, "--method", "LoRes", "--n-star", "64"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("VIP_WINDOW=OFF"), HasSubstr("--headless")));
}

}  // namespace
}  // namespace apps::test
