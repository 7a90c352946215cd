#include "libsim/foam/foam_pool.hpp"

#include <algorithm>
#include <cmath>

namespace sim::SIM_BACKEND {

namespace {

float count_along(float length, float edge) { return std::max(1.0f, std::ceil(length / edge - 1e-4f)); }

}  // namespace

float MeetingCells::edge_of(const Domain& domain, float wish) {
  const Vec3 size = domain.high - domain.low;
  float edge = wish;
  for (;;) {
    const double cells = static_cast<double>(count_along(size.x, edge)) *
                         static_cast<double>(count_along(size.y, edge)) *
                         static_cast<double>(count_along(size.z, edge));
    if (cells <= most_cells) return edge;
    // The cube root suffices only if all three axes save cells. In flat tanks fewer axes do, and the loop
    // repeats.
    edge *= static_cast<float>(std::max(1.01, std::cbrt(cells / most_cells)));
  }
}

void MeetingCells::lay(const Domain& domain, float edge, float finest_support) {
  const auto count = [&](float length) { return static_cast<int>(count_along(length, edge)); };
  const Vec3 size = domain.high - domain.low;
  grid = {{domain.low, edge}, {count(size.x), count(size.y), count(size.z)}};
  // Side of the last of n cells inside the tank, as a share of the edge. From 0.9999 on it counts as a whole
  // cell: the missing part is only a rounding error of the length.
  const auto rest = [&](float length, int n) {
    const float left = length / edge - static_cast<float>(n - 1);
    return left > 0.9999f ? 1 : left;
  };
  last = {rest(size.x, grid.block.nx), rest(size.y, grid.block.ny), rest(size.z, grid.block.nz)};
  const float spacings = 2 * edge / finest_support;
  full = spacings * spacings * spacings;
  sums.reserve(grid.cells());
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
