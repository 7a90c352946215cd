#pragma once
/// Orders of k items, as permutations of 0 .. k - 1.

#include <functional>
#include <vector>

#include "libstudy/base/random.hpp"

namespace study {

/// Row `row` of the cyclic Latin square: over k rows, each item occurs once at each position.
std::vector<int> latin_row(int k, int row);

/// Rows of a Williams design: k when k is even, 2 k when it is odd.
int williams_rows(int k);
/// Row `row` of a Williams design: over all rows, each item occurs equally often at each position and
/// directly after each other item (Williams 1949).
std::vector<int> williams_row(int k, int row);

/// A random order without clashing neighbours. Each next item is drawn from those that do not clash with the
/// last; if none is left, the search starts over. Empty after 10,000 failed starts (fewer if k is above 141).
/// Not every such order is equally likely.
std::vector<int> order_without_clashes(int k, const std::function<bool(int, int)>& clash,
                                       RandomStream& random);

}  // namespace study
