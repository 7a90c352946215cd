/// Suggestions of the known word that is nearest to an unknown one.

#include "stats/base/nearest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using base::edit_distance;
using base::nearest_word;

TEST(Nearest, CountsTheFewestEdits) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("abc", "abc"), 0u);
  EXPECT_EQ(edit_distance("OURS", "ours"), 0u);
  EXPECT_EQ(edit_distance("lattin", "latin"), 1u);
  EXPECT_EQ(edit_distance("laitn", "latin"), 1u) << "neighbours swapped";
  EXPECT_EQ(edit_distance("ca", "abc"), 3u) << "no letter is edited twice";
}

TEST(Nearest, NamesAWordThatIsNearAndNoOther) {
  const std::vector<std::string> methods{"LoRes", "HiRes", "FovFluid", "Ours", "Ours-TSp"};
  EXPECT_EQ(nearest_word("ours", methods), "Ours");
  EXPECT_EQ(nearest_word("HighRes", methods), "HiRes");
  EXPECT_EQ(nearest_word("ours-tps", methods), "Ours-TSp");
  EXPECT_EQ(nearest_word("Bogus", methods), "");
  EXPECT_EQ(nearest_word("", methods), "");
  EXPECT_EQ(nearest_word("ours", {}), "");
  EXPECT_EQ(nearest_word(std::string(100000, 'x'), methods), "");
}

TEST(Nearest, TheMendListsAllAndNamesTheNearest) {
  EXPECT_EQ(base::use_one_of("latim", {"shuffle", "latin"}),
            "use one of \"shuffle\", \"latin\"; the nearest is \"latin\"");
  EXPECT_EQ(base::use_one_of("q", {"shuffle", "latin"}), "use one of \"shuffle\", \"latin\"");
}

}  // namespace
