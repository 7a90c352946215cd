/// Common behaviour of all programs: help, version, wrong command lines, the choice of a back end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
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
    EXPECT_THAT(version.out, StartsWith(program + " " + base::version() + "\nbuilt 20")) << program;
    for (const char* option :
         {" by ", ", CUDA O", ", windows O", ", effects O", ", instructions of one processor O"})
      EXPECT_THAT(version.out, HasSubstr(option)) << program;
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

TEST(ProgramsE2e, OutputThatDoesNotArriveIsAnError) {
  const auto to_full = [](const std::string& line) {
    return run_program({"/bin/sh", "-c", path_of(line) + " >/dev/full"});
  };
  for (const std::string& program : programs) {
    for (const char* option : {" --help", " --version"}) {
      const Ended ended = to_full(program + option);
      EXPECT_EQ(ended.exit_code, 1) << program;
      EXPECT_THAT(ended.err, AllOf(HasSubstr("standard output: cannot be written"), HasSubstr("mend: ")));
    }
  }
  // The reference fills more than one output buffer, so a write to the full device fails long before the end.
  EXPECT_EQ(to_full("vip-study reference").exit_code, 1);
}

TEST(ProgramsE2e, AReaderThatLeftIsNoSignalAndNoWord) {
  for (const std::string& program : programs) {
    const Ended ended = run_program({path_of(program), "--help"}, [] {
      int ends[2];
      if (::pipe(ends) != 0) ::_exit(125);
      ::close(ends[0]);
      ::dup2(ends[1], STDOUT_FILENO);
    });
    EXPECT_EQ(ended.exit_code, 1) << program << " ended by signal " << ended.signal;
    EXPECT_EQ(ended.err, "") << program;
  }
}

TEST(ProgramsE2e, NumbersThatNoTypeHoldsAreErrors) {
  const std::vector<Arguments> wrong{
      {"vip-study", "run", "p.toml", "--db", "s.db", "--seed", "99999999999999999999"},
      {"vip-study", "run", "p.toml", "--db", "s.db", "--max-pages", "9223372036854775808"},
      {"vip-study", "run", "p.toml", "--db", "s.db", "--trial-seconds", "1e999"},
      {"vip-study", "run", "p.toml", "--db", "s.db", "--screen-width-mm", "nan"},
      {"vip-study", "run", "p.toml", "--db", "s.db", "--seed", "0x10"},
      {"vip-study", "run", "p.toml", "--db", "s.db", "--seed", "1.5"},
      {"vip-stats", "fit-ptpe", "s.db", "--seed", "99999999999999999999"},
      {"vip-stats", "fit-ptpe", "s.db", "--seed", "-1"},
      {"vip-stats", "fit-ptpe", "s.db", "--level", "1e999"},
      {"vip-stats", "fit-ptpe", "s.db", "--max-width", "1e999"},
      {"vip-stats", "power", "p.toml", "--seed", "18446744073709551616"},
      {"vip-stats", "preregister", "p.toml", "--out", "x", "--seed", "99999999999999999999"},
      {"vip-bench", "frame", "s.toml", "--frames", "99999999999999999999"},
      {"vip-view", "s.toml", "--levels", "99999999999999999999"}};
  for (const Arguments& line : wrong) {
    Arguments arguments = line;
    arguments[0] = path_of(line[0]);
    const Ended ended = run_program(arguments);
    EXPECT_EQ(ended.exit_code, 2) << line[0] << " " << line.back() << ": " << ended.err;
    EXPECT_THAT(ended.err,
                AllOf(HasSubstr(line[line.size() - 2]), HasSubstr("\"" + line.back() + "\" is not a")));
  }
}

TEST(ProgramsE2e, ZerosBeforeANumberAreNoOctal) {
  const TemporaryFolder folder;
  const Ended ended =
      run_program({path_of("vip-study"), "run", base::resource("protocols/ptpe_pilot.toml"), "--db",
                   folder / "s.db", "--observer", "constant:4", "--participants", "1", "--seed", "010"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(count_in(folder / "s.db", "SELECT seed FROM session"), 10);
}

/// Tries every program with every kind of input that is no file. Opening a pipe without a writer would wait
/// forever.
TEST(ProgramsE2e, InputsThatAreNoFilesAreRefusedAtOnce) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe", out = folder / "out";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& input : {pipe, std::string("/dev/zero"), folder.path().string()}) {
    for (const std::string& line :
         {"vip-study check " + input, "vip-study bake " + input + " --out " + out,
          "vip-study bake --verify " + input, "vip-study status --db " + input,
          "vip-study resume --db " + input,
          "vip-study run protocols/ptpe_pilot.toml --observer constant:4 --db " + input,
          "vip-study run protocols/ptpe_pilot.toml --observer constant:4 --db " + out + " --stimulus " +
              input,
          "vip-study run protocols/ptpe_pilot.toml --observer constant:4 --db " + out + " --ptpe " + input,
          "vip-study export --csv " + out + " --db " + input, "vip-study merge " + input + " --into " + out,
          "vip-study withdraw P01 --yes --db " + input, "vip-stats fit-ptpe " + input,
          "vip-stats report " + input + " --html " + out, "vip-stats power " + input,
          "vip-bench frame " + input, "vip-view --headless " + input}) {
      const Ended ended = run_shell("timeout 20 " + path_of(line));
      EXPECT_EQ(ended.exit_code, 1) << line << "\n" << ended.out;
      EXPECT_THAT(ended.out, AllOf(HasSubstr(input), HasSubstr("mend: "))) << line;
    }
  }
}

TEST(ProgramsE2e, ValuesOfAFileAreEchoedShortly) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "long.toml";
  base::write_file_atomically(
      protocol,
      replaced(short_protocol("10"), "order = ", "order = \"" + std::string(900'000, 'x') + "\" # "));
  const Ended ended = run_program({path_of("vip-study"), "check", protocol});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_LT(ended.err.size(), 2000u);
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("xxx ... (900"), HasSubstr("is not a known choice"), HasSubstr("mend: ")));
}

TEST(ProgramsE2e, ArgumentsAreUtf8OnOneLineAndEchoedShortly) {
  for (const std::string& program : programs) {
    for (const char* bad : {"\xFF", "a\nb", "a\x1b[31mb", "Z\xFCrich"}) {
      const Ended ended = run_program({path_of(program), "--station", bad});
      EXPECT_EQ(ended.exit_code, 2) << program;
      EXPECT_THAT(ended.err, HasSubstr("argument 2")) << program;
      EXPECT_EQ(ended.err.find('\x1b'), std::string::npos);
    }
    const Ended ended = run_program({path_of(program), "--" + std::string(100'000, 'x')});
    EXPECT_EQ(ended.exit_code, 2) << program;
    EXPECT_LT(ended.err.size(), 2000u) << program;
  }
}

/// Makes the program find no GPU, as if the driver were missing.
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
