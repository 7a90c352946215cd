/// scripts/planted_defects.sh takes minutes. This test runs only its --check: each defect can still be
/// planted, and docs/results.md lists it.

#include <gtest/gtest.h>

#include <cstdlib>

namespace {

TEST(PlantedDefects, StandWhereTheyArePlantedAndInTheDocs) {
  EXPECT_EQ(std::system("'" VIP_TEST_DIR "/../scripts/planted_defects.sh' --check"), 0);
}

}  // namespace
