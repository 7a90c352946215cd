#include "stats/base/duration.hpp"

#include <gtest/gtest.h>

namespace {

TEST(Duration, IsInTheUnitThatPeopleUse) {
  EXPECT_EQ(base::duration_words(40), "40 s");
  EXPECT_EQ(base::duration_words(90), "2 min");
  EXPECT_EQ(base::duration_words(73 * 60), "73 min");
  EXPECT_EQ(base::duration_words(3.5 * 3600), "3.5 h");
}

}  // namespace
