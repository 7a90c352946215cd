/// What every program does before anything else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {

namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// libgomp's account of its settings, from a start with `name` set to `value` (empty = neither is set).
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

}  // namespace

}  // namespace apps::test
