#include "libstudy/design/station.hpp"

#include <algorithm>
#include <numeric>

#include "libstudy/design/plan.hpp"
#include "stats/base/error.hpp"
#include "stats/base/pattern.hpp"

namespace study {

std::optional<StationNumber> parse_station_number(const std::string& station) {
  static const base::Pattern pattern("(.* )?([0-9]{1,9})/([0-9]{1,9})");
  const auto found = pattern.match(station);
  if (!found) return {};
  const StationNumber out{std::stoi(found->at(2)), std::stoi(found->at(3))};
  if (out.number < 1 || out.number > out.count || out.count > 999)
    throw base::Error(
        "--station " + station, "is not a station number",
        "write NUMBER/COUNT, such as 2/5 for station 2 of 5; NUMBER is from 1 to COUNT, COUNT at most 999");
  return out;
}

std::string station_text(const StationNumber& station) {
  return std::to_string(station.number) + "/" + std::to_string(station.count);
}

std::uint64_t seed_of_station(std::uint64_t seed, const std::optional<StationNumber>& station) {
  if (!station) return seed;
  return random_key(std::to_string(seed) + "\nstation " + std::to_string(station->number)) >> 1;
}

int next_slot(const Protocol& protocol, const std::vector<int>& taken,
              const std::optional<StationNumber>& station) {
  if (!station) return next_slot(protocol, taken);
  const int slots = slot_count(protocol), shared = std::gcd(slots, station->count);
  std::vector<int> count(static_cast<std::size_t>(slots));
  for (const int slot : taken) ++count[static_cast<std::size_t>(slot) % count.size()];
  const auto dealt = [&](int turn) {
    return static_cast<int>((station->number - 1 + std::int64_t{turn} * station->count) % slots);
  };
  int best = dealt(0);
  for (int turn = 1; turn < slots / shared; ++turn) {
    if (count[static_cast<std::size_t>(dealt(turn))] < count[static_cast<std::size_t>(best)])
      best = dealt(turn);
  }
  return best;
}

}  // namespace study
