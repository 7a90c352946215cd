#include "libsim/pressure/coarse_grid.hpp"

#include <algorithm>

#include "libsim/pressure/grid_passes.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Open shares by samples of the distance, each smoothed over its own width.
struct CutCells {
  static constexpr int samples = 4;  ///< along an edge
  PressureFrame frame;
  CutView grid;
  Solids solids;

  SIM_FN void operator()(int i) const {
    const Place p = place_of(grid.block, i);
    const auto low = [](int cell) { return static_cast<float>(cell); };
    const Vec3 corner{low(p.x), low(p.y), low(p.z)};
    const float away = solids.nearest_body(frame.in_metres(corner + Vec3{0.5f, 0.5f, 0.5f}));
    const float reach = 0.625f * length(frame.edge);
    if (fabsf(away) > reach) {
      const float open = away > 0 ? 1.0f : 0.0f;
      grid.open_volume[i] = open;
      grid.open_low[i] = {open, open, open};
      return;
    }
    grid.open_volume[i] = open_share(corner, samples, samples, samples);
    grid.open_low[i] = {open_share(corner, 0, samples, samples), open_share(corner, samples, 0, samples),
                        open_share(corner, samples, samples, 0)};
  }

  /// Of the box of samples along each axis; an axis without any lies in the low face.
  SIM_FN float open_share(Vec3 corner, int nx, int ny, int nz) const {
    const auto at = [](int k, int n) { return n == 0 ? 0.0f : (static_cast<float>(k) + 0.5f) / samples; };
    const float width = (frame.edge.x + frame.edge.y + frame.edge.z) / (3 * samples);
    float sum = 0;
    int count = 0;
    for (int a = 0; a < nx || a == 0; ++a) {
      for (int b = 0; b < ny || b == 0; ++b) {
        for (int c = 0; c < nz || c == 0; ++c) {
          const Vec3 x = frame.in_metres(corner + Vec3{at(a, nx), at(b, ny), at(c, nz)});
          sum += at_most(at_least(0.5f + solids.nearest_body(x) / width, 0.0f), 1.0f);
          ++count;
        }
      }
    }
    const float share = sum / static_cast<float>(count);
    return share < least_open ? 0.0f : share;
  }
  static constexpr float least_open = 0.02f;
};

}  // namespace

CutView CoarseGrid::cut(const Solids& solids) {
  CutView out = multigrid.finest_cut();
  open_volume.resize(static_cast<std::size_t>(out.block.size()));
  out.open_volume = open_volume.data();
  for_each("cut cells", out.block.size(), CutCells{frame, out, solids});
  return out;
}

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
