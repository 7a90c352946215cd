#pragma once
/// Ids for new particles.

#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// Lists the ids below the capacity that no particle has, in ascending order, in ids; ids beyond the capacity
/// have no place there. `gone`: particles that no longer count; nullptr: all of them do. `flags` and `sums`
/// are room for the search; all three come to have one value for each id of the capacity.
void list_free_ids(Reads<Column::Id> particles, const std::uint8_t* gone, Scanner& scanner, Array<int>& flags,
                   Array<int>& sums, Array<int>& ids);

}  // namespace sim::SIM_BACKEND
