#pragma once
/// What a slot of the assignment means: groups, round and row.

#include <cstdint>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace study {

struct Deal {
  std::vector<int> groups;  ///< in order of presentation, as indices into cell_groups()
  int round = 0;            ///< number of complete passes through all sequences before this slot
  /// First row of the square; the k-th group shown takes the k-th row after it. Over all slots, each sequence
  /// begins equally often with each row; for pairs, in both interval orders.
  int row = 0;
};

/// slot >= 0. Under Assignment::PaperRandom the groups are drawn with `key`.
Deal deal(const Protocol& protocol, int slot, std::uint64_t key);

}  // namespace study
