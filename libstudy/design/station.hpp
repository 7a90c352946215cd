#pragma once
/// Several stations that record one study. Each station assigns to its participants its own share of the
/// slots (the groups and orders of cells that the design balances) and uses its own seed. If all stations
/// record equally many people, they together use the slots as one station would.

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

/// Parses the station number at the end of a station's name, such as "2/5" or "lab2 2/5". None if the name
/// does not end in a station number. base::Error for an impossible number, such as "6/5".
std::optional<StationNumber> parse_station_number(const std::string& station);

/// The station number as text: "2/5".
std::string station_text(const StationNumber& station);

/// The seed of a station's sessions, at most 2^63 - 1, computed from the study's seed and
/// StationNumber::number. So participant code P01 gets different orders at two stations. Without a station
/// number, returns `seed`.
std::uint64_t seed_of_station(std::uint64_t seed, const std::optional<StationNumber>& station);

/// The slot for the station's next participant. Station k of n assigns every n-th slot from slot k - 1 on,
/// modulo slot_count(). Of the least used of these slots, returns the first in this order. Without a station
/// number, returns next_slot(protocol, taken).
int next_slot(const Protocol& protocol, const std::vector<int>& taken,
              const std::optional<StationNumber>& station);

}  // namespace study
