#pragma once
/// How long what is left of a session will take.

#include <span>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// Seconds that a unit is expected to take: what its block says, 3.5 words a second for reading, 5 s for each
/// question to choose in, 10 s for a number and 30 s for words. A simulated person reads and answers at once.
/// showing_s: what a showing of each cell of the design takes here; empty: as planned.
double expected_s(const study::Protocol& protocol, const study::OpenUnit& unit, bool person = true,
                  std::span<const double> showing_s = {});
double expected_s(const study::Protocol& protocol, std::span<const study::OpenUnit> units, bool person = true,
                  std::span<const double> showing_s = {});

/// Bytes that the units will add to a database, about: its frames, 64 bytes each, and 4 KiB for each unit.
std::uint64_t expected_bytes(const study::Protocol& protocol, std::span<const study::OpenUnit> units);

}  // namespace apps
