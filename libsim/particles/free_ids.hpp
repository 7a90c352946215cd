#pragma once
/// Ids for new particles.

#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// Lists in `ids` the unused ids below the capacity, in ascending order; ids beyond the capacity are ignored.
/// `gone`: flags of particles that no longer count; nullptr: none. `flags` and `sums` are scratch memory; all
/// three get one value per id of the capacity.
void list_free_ids(Reads<Column::Id> particles, const std::uint8_t* gone, Scanner& scanner, Array<int>& flags,
                   Array<int>& sums, Array<int>& ids);

}  // namespace sim::SIM_BACKEND
