#pragma once
/// Several stations that record one study. Each station deals its own share of the assignment and uses its
/// own seed. Together they use the assignment as one station would.

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

/// The number at the end of a station's name: "2/5", or "lab2 2/5". None if the name has no number.
/// base::Error for an impossible number, such as "6/5".
std::optional<StationNumber> parse_station_number(const std::string& station);

/// "2/5"
std::string station_text(const StationNumber& station);

/// The seed of a station's sessions, so that P01 has different orders at two stations. `seed` if there is no
/// number. At most 2^63 - 1.
std::uint64_t seed_of_station(std::uint64_t seed, const std::optional<StationNumber>& station);

/// The slot for the station's next participant: the first of the least used slots that this station deals.
/// Station k of n deals every n-th slot, from slot k - 1 on, and starts over after the last. Without a
/// number: next_slot(protocol, taken).
int next_slot(const Protocol& protocol, const std::vector<int>& taken,
              const std::optional<StationNumber>& station);

}  // namespace study
