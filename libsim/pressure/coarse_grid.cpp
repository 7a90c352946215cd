#include "libsim/pressure/coarse_grid.hpp"

#include <algorithm>

namespace sim::SIM_BACKEND {

void CoarseGrid::fit(const Domain& domain, float edge) {
  const Vec3 size = domain.high - domain.low;
  const double wish = static_cast<double>(size.x) * static_cast<double>(size.y) *
                      static_cast<double>(size.z) / std::pow(static_cast<double>(edge), 3.0);
  if (wish > most_cells) edge *= static_cast<float>(std::cbrt(wish / most_cells));
  frame = {domain.low, edge};
  const auto cells = [&](float length) { return std::max(1, static_cast<int>(std::ceil(length / edge))); };
  multigrid.fit({cells(size.x), cells(size.y), cells(size.z)});
  sums.resize(static_cast<std::size_t>(multigrid.finest().block.size()));
}

}  // namespace sim::SIM_BACKEND
