/// S24: a run takes no more memory the longer it lasts.

#include <gtest/gtest.h>

#include <algorithm>

#include "libsim/cases/hard_case.hpp"

namespace {

TEST(S24Soak, TheProcessDoesNotGrow) {
  const auto outcome = sim::cases::hard_case("S24").run({.method = sim::MethodKind::FovFluid});
  const auto grown = std::find_if(outcome.findings.begin(), outcome.findings.end(),
                                  [](const auto& one) { return one.name == "growth of the process"; });
  ASSERT_NE(grown, outcome.findings.end());
  // MiB over 600 frames: a leak of 30 KiB a frame would show.
  EXPECT_LT(grown->value, 16);
}

}  // namespace
