/// Start-up and error handling common to all programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <CLI/CLI.hpp>

#include <stdexcept>

#include "apps/common/program.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {

namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// libgomp's report of its settings when started with `name` set to `value` (empty: neither variable is set).
std::string openmp_settings(const std::string& name = "", const std::string& value = "") {
  const Ended ended = run_program({vip_study, "--version"}, [&] {
    ::unsetenv("OMP_WAIT_POLICY");
    ::unsetenv("GOMP_SPINCOUNT");
    ::setenv("OMP_DISPLAY_ENV", "verbose", 1);
    if (!name.empty()) ::setenv(name.c_str(), value.c_str(), 1);
  });
  EXPECT_EQ(ended.exit_code, 0);
  return ended.err;
}

TEST(ProgramE2e, OpenMpThreadsDoNotSpin) {
  EXPECT_THAT(openmp_settings(), HasSubstr("GOMP_SPINCOUNT = '0'"));
}

TEST(ProgramE2e, AChoiceOfTheUsersStays) {
  EXPECT_THAT(openmp_settings("OMP_WAIT_POLICY", "active"), Not(HasSubstr("GOMP_SPINCOUNT = '0'")));
  EXPECT_THAT(openmp_settings("GOMP_SPINCOUNT", "77"), HasSubstr("GOMP_SPINCOUNT = '77'"));
}

/// Expects that a program whose command calls `thrower` prints text like `pattern` on stderr and exits with
/// status 1.
void expect_said(const std::function<void()>& thrower, const std::string& pattern) {
  const auto run = [&] {
    ::setenv("OMP_WAIT_POLICY", "passive", 1);  // so that the program does not restart itself
    CLI::App app("", "vip-some");
    app.add_subcommand("thing", "")->callback(thrower);
    char name[] = "vip-some", command[] = "thing";
    char* arguments[] = {name, command, nullptr};
    std::exit(apps::run_program(app, 2, arguments));
  };
  EXPECT_EXIT(run(), ::testing::ExitedWithCode(1), pattern);
}

TEST(ProgramDeathTest, ErrorsOfOtherLibrariesHavePlaceAndMendToo) {
  expect_said([] { throw std::out_of_range("vector::at"); },
              "vip-some: error: vip-some thing: unexpected: vector::at\n  mend: .*report");
  expect_said([] { std::filesystem::create_directory("/none/such"); },
              "error: /none/such: unexpected: No such file or directory\n  mend: ");
  expect_said([] { throw std::bad_alloc(); }, "error: vip-some thing: out of memory\n  mend: ");
  expect_said([] { throw base::Error("here", "is wrong", "mend it"); },
              "error: here: is wrong\n  mend: mend it\n");
}

}  // namespace

}  // namespace apps::test
