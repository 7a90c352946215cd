#pragma once
/// Orders of k things, as permutations of 0 .. k - 1.

#include <functional>
#include <vector>

#include "libstudy/base/random.hpp"

namespace study {

/// Row `row` of the cyclic Latin square: over k rows each thing stands once at each place.
std::vector<int> latin_row(int k, int row);

/// Rows of a Williams design: k when k is even, 2 k when it is odd.
int williams_rows(int k);
/// Row `row` of it: over all rows each thing stands equally often at each place and directly after each other
/// thing (Williams 1949).
std::vector<int> williams_row(int k, int row);

/// A random order in which no neighbours clash: built one after another from those that do not, started over
/// where none is left. Empty when 10,000 starts (fewer where k is above 141) found none. Not every such order
/// is equally likely.
std::vector<int> order_without_clashes(int k, const std::function<bool(int, int)>& clash,
                                       RandomStream& random);

}  // namespace study
