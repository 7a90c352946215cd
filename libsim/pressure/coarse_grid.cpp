#include "libsim/pressure/coarse_grid.hpp"

#include <algorithm>

namespace sim::SIM_BACKEND {

void CoarseGrid::fit(const Domain& domain, float edge) {
  const Vec3 size = domain.high - domain.low;
  const double wish = static_cast<double>(size.x) * static_cast<double>(size.y) *
                      static_cast<double>(size.z) / std::pow(static_cast<double>(edge), 3.0);
  if (wish > most_cells) edge *= static_cast<float>(std::cbrt(wish / most_cells));
  const auto across = [&](float length) { return std::max(1, static_cast<int>(std::round(length / edge))); };
  const int nx = across(size.x);
  const int nz = across(size.z);
  const int ny = std::max(1, static_cast<int>(std::ceil(size.y / edge)));  // open above
  frame = {domain.low, {size.x / static_cast<float>(nx), edge, size.z / static_cast<float>(nz)}};
  multigrid.fit({nx, ny, nz}, frame.conductance());
  sums.resize(static_cast<std::size_t>(multigrid.finest().block.size()));
}

}  // namespace sim::SIM_BACKEND
