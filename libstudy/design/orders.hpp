#pragma once
/// Orders of k items, as permutations of 0 .. k - 1.

#include <functional>
#include <vector>

#include "libstudy/base/random.hpp"

namespace study {

/// Row `row` of the cyclic Latin square of k items: over all k rows, each item occurs once at each position.
std::vector<int> latin_row(int k, int row);

/// Number of rows of a Williams design of k items: k if k is even or 1, otherwise 2 k.
int williams_rows(int k);
/// Row `row` of a Williams design: over all rows, each item occurs equally often at each position and
/// directly after each other item (Williams 1949).
std::vector<int> williams_row(int k, int row);

/// A random order of 0 .. k - 1 in which no two successive items clash. Each next item is drawn from the
/// remaining items that do not clash with the item before. If all remaining items clash, the search starts
/// over. Returns an empty order after 10,000 failed starts (fewer if k is above 141). Not all orders without
/// clashes are equally likely.
std::vector<int> order_without_clashes(int k, const std::function<bool(int, int)>& clash,
                                       RandomStream& random);

}  // namespace study
