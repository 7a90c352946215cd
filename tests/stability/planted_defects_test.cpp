/// scripts/planted_defects.sh takes minutes; this test only runs its --check, so that it stays usable.

#include <gtest/gtest.h>

#include <cstdlib>

namespace {

TEST(PlantedDefects, StandWhereTheyArePlantedAndInTheDocs) {
  EXPECT_EQ(std::system("'" VIP_TEST_DIR "/../scripts/planted_defects.sh' --check"), 0);
}

}  // namespace
