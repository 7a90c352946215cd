#include "libsim/pressure/coarse_grid.hpp"

#include <algorithm>

namespace sim::SIM_BACKEND {

void CoarseGrid::fit(const Domain& domain, float edge, bool lid) {
  const Vec3 size = domain.high - domain.low;
  const double wish = static_cast<double>(size.x) * static_cast<double>(size.y) *
                      static_cast<double>(size.z) / std::pow(static_cast<double>(edge), 3.0);
  if (wish > most_cells) edge *= static_cast<float>(std::cbrt(wish / most_cells));
  const auto across = [&](float length) { return std::max(1, static_cast<int>(std::round(length / edge))); };
  const int nx = across(size.x);
  const int nz = across(size.z);
  const int ny = lid ? across(size.y) : std::max(1, static_cast<int>(std::ceil(size.y / edge)));
  const float edge_y = lid ? size.y / static_cast<float>(ny) : edge;
  frame = {domain.low, {size.x / static_cast<float>(nx), edge_y, size.z / static_cast<float>(nz)}};
  multigrid.fit({nx, ny, nz}, frame.conductance(), lid ? CellKind::Solid : CellKind::Air);
  sums.resize(static_cast<std::size_t>(multigrid.finest().block.size()));
}

void CoarseGrid::open(const Walls& walls) {
  const Vec3 e = frame.edge;
  const bool same_cells = e.x == opened_edge_.x && e.y == opened_edge_.y && e.z == opened_edge_.z;
  if (opened_ == walls.opening_count && (opened_ == 0 || same_cells)) return;
  opened_ = walls.opening_count;
  opened_edge_ = e;
  std::vector<OpenFace> faces;
  for (int o = 0; o < walls.opening_count; ++o) {
    const Opening& opening = walls.openings[o];
    const Vec3 normal = walls.planes[opening.plane].normal;
    const Vec3 low = frame.in_cells(opening.low);
    const Vec3 high = frame.in_cells(opening.high);
    OpenFace face{};
    if (normal.x != 0) {
      face = {0, normal.x < 0, {low.y, low.z}, {high.y, high.z}};
    } else if (normal.y != 0) {
      face = {1, normal.y < 0, {low.x, low.z}, {high.x, high.z}};
    } else {
      face = {2, normal.z < 0, {low.x, low.y}, {high.x, high.y}};
    }
    faces.push_back(face);
  }
  multigrid.open(faces);
}

}  // namespace sim::SIM_BACKEND
