#include "libsim/foam/foam_pool.hpp"

#include <algorithm>
#include <cmath>

namespace sim::SIM_BACKEND {

void MeetingCells::lay(const Domain& domain, float edge, float finest_support) {
  const auto count = [&](float length) {
    return std::max(1, static_cast<int>(std::ceil(length / edge - 1e-4f)));
  };
  const Vec3 size = domain.high - domain.low;
  grid = {{domain.low, edge}, {count(size.x), count(size.y), count(size.z)}};
  const float spacings = 2 * edge / finest_support;
  full = spacings * spacings * spacings;
  sums.resize(static_cast<std::size_t>(grid_levels * grid.cells()));
  meeting.resize(static_cast<std::size_t>(grid.cells()));
}

void FoamPool::begin(int most, int water) {
  const auto size = static_cast<std::size_t>(most);
  place.resize(size);
  velocity.resize(size);
  place.zero();
  velocity.zero();
  ledger.resize(1);
  ledger.zero();
  free.resize(size);
  free_of.resize(size);
  for (auto* each : {&births, &sums}) each->reserve(static_cast<std::size_t>(water));
  approach.reserve(static_cast<std::size_t>(water));
  frame = 0;
}

}  // namespace sim::SIM_BACKEND
