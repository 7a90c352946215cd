/// scripts/planted_defects.sh takes minutes; here is what keeps it able to run.

#include <gtest/gtest.h>

#include <cstdlib>

namespace {

TEST(PlantedDefects, StandWhereTheyArePlantedAndInTheDocs) {
  EXPECT_EQ(std::system("'" VIP_TEST_DIR "/../scripts/planted_defects.sh' --check"), 0);
}

}  // namespace
