#pragma once
/// Several stations that record one study: each deals a share of the assignment that no other station deals,
/// and orders its participants by a seed of its own. Together they use the assignment as one station would.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace study {

/// Station `number` of `count`: 1 <= number <= count <= 999.
struct StationNumber {
  int number = 1, count = 1;
  bool operator==(const StationNumber&) const = default;
};

/// The number at the end of a station's name: "2/5", or "lab2 2/5". None: the name has no number.
/// base::Error for a number that no station can have, such as "6/5".
std::optional<StationNumber> parse_station_number(const std::string& station);

/// "2/5"
std::string station_text(const StationNumber& station);

/// The seed of a station's sessions: P01 of two stations has different orders. Without a number: `seed`.
/// At most 2^63 - 1.
std::uint64_t seed_of_station(std::uint64_t seed, const std::optional<StationNumber>& station);

/// The slot for the station's next participant: of the slots that the station deals, the first of those that
/// are least taken. Station k of n deals every n-th slot, from slot k - 1 on, and starts over after the last.
/// Without a number: next_slot(protocol, taken).
int next_slot(const Protocol& protocol, const std::vector<int>& taken,
              const std::optional<StationNumber>& station);

}  // namespace study
