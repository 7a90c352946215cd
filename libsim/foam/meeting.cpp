#include "libsim/foam/foam_pool.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Number of cells in the block of a cell and the 26 around it, and index of the middle cell. way_to(k):
/// vector from the middle cell to cell k, in edges.
constexpr int nearby = 27;
constexpr int middle = 13;
SIM_FN Vec3 way_to(int k) {
  return {static_cast<float>(k % 3 - 1), static_cast<float>(k / 3 % 3 - 1), static_cast<float>(k / 9 - 1)};
}

/// Least-squares fit of the gradient G of v: minimises the sum of w |dv - G dx|^2 / dx^2.
struct GradientFit {
  Vec3 bx{}, by{}, bz{};            // sum of w dv dx / dx^2, one row per component of v
  Vec3 diagonal{}, off_diagonal{};  // sum of w dx dx / dx^2: the diagonal, then yz, xz, xy
  float weight = 0;

  SIM_FN void add(Vec3 dx, Vec3 dv, float w) {
    const Vec3 e = (w / dot(dx, dx)) * dx;
    bx += dv.x * e;
    by += dv.y * e;
    bz += dv.z * e;
    diagonal += Vec3{e.x * dx.x, e.y * dx.y, e.z * dx.z};
    off_diagonal += Vec3{e.y * dx.z, e.x * dx.z, e.x * dx.y};
    weight += w;
  }

  /// Mean of |G e| over the 13 axes e through the faces, edges and corners of a cube, minus the mean of e G e
  /// over all directions.
  SIM_FN float approach() const {
    if (!(weight > 0)) return 0;
    // `least` is added to the diagonal: in a sheet one cell thick no water beside the sheet enters the fit,
    // and the system would be singular. G is 0 across such a sheet.
    const float least = 0.02f / 3 * weight;
    const float xx = diagonal.x + least;
    const float yy = diagonal.y + least;
    const float zz = diagonal.z + least;
    const float yz = off_diagonal.x;
    const float xz = off_diagonal.y;
    const float xy = off_diagonal.z;
    const Vec3 cx{yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy};
    const Vec3 cy{cx.y, xx * zz - xz * xz, xy * xz - xx * yz};
    const Vec3 cz{cx.z, cy.z, xx * yy - xy * xy};
    const float scale = 1 / (xx * cx.x + xy * cx.y + xz * cx.z);
    const auto row = [&](Vec3 b) { return scale * Vec3{dot(cx, b), dot(cy, b), dot(cz, b)}; };
    const Vec3 gx = row(bx);
    const Vec3 gy = row(by);
    const Vec3 gz = row(bz);
    float sum = 0;
    for (int k = middle + 1; k < nearby; ++k) {
      const Vec3 way = way_to(k);
      const Vec3 e = (1 / length(way)) * way;
      sum += length(Vec3{dot(gx, e), dot(gy, e), dot(gz, e)});
    }
    return at_least(sum / middle - (gx.x + gy.y + gz.z) / 3, 0.0f);
  }
};

SIM_FN bool in_a_body(const Walls&, Vec3) { return false; }
SIM_FN bool in_a_body(const Solids& solids, Vec3 x) { return solids.nearest_body(x) < 0; }

template <class Bounds>
struct MeetFoam {
  const MomentumSum* sums;
  GridFrame grid;
  Vec3 last;
  float full;
  Bounds bounds;
  Vec4* meeting;

  SIM_FN MomentumSum of(int cell) const {
    MomentumSum all{};
    for (int level = 0; level < grid_levels; ++level) {
      const MomentumSum& part = sums[level * grid.cells() + cell];
      all = {all.mass + part.mass, all.x + part.x, all.y + part.y, all.z + part.z};
    }
    return all;
  }

  /// Side lengths of a cell as shares of the edge: 1, or less where the wall at the high end of an axis cuts
  /// the cell.
  SIM_FN Vec3 sides(int x, int y, int z) const {
    const CellBlock& block = grid.block;
    return {x == block.nx - 1 ? last.x : 1, y == block.ny - 1 ? last.y : 1, z == block.nz - 1 ? last.z : 1};
  }

  SIM_FN void operator()(int cell) const {
    meeting[cell] = {0, 0, 0, value_unknown};
    const MomentumSum own = of(cell);
    if (own.mass == 0) return;
    const Vec3 v = mean_velocity(own);
    const CellBlock& block = grid.block;
    const int own_x = cell % block.nx;
    const int own_y = cell / block.nx % block.ny;
    const int own_z = cell / (block.nx * block.ny);
    const Vec3 mine = sides(own_x, own_y, own_z);
    GradientFit fit;
    float whole = 0;
    for (int k = 0; k < nearby; ++k) {
      const Vec3 to = way_to(k);
      const int x = own_x + k % 3 - 1;
      const int y = own_y + k / 3 % 3 - 1;
      const int z = own_z + k / 9 - 1;
      // Cells beyond the tank do not count as missing water.
      if (k == middle || !block.holds(x, y, z)) continue;
      const Vec3 theirs = sides(x, y, z);
      const float room = theirs.x * theirs.y * theirs.z;
      const float weight = 1 / (dot(to, to) * dot(to, to));
      const MomentumSum other = of(block.index(x, y, z));
      const float wet = at_most(static_cast<float>(other.mass) / full, room);
      const Vec3 at{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
      const Vec3 centre = grid.frame.low + grid.frame.edge * (at + 0.5f * theirs);
      // The empty part of a cell in an obstacle does not count as missing water.
      whole += weight * (in_a_body(bounds, centre) ? wet : room);
      if (other.mass == 0) continue;
      const Vec3 both = 0.5f * (mine + theirs);
      fit.add({to.x * both.x, to.y * both.y, to.z * both.z}, mean_velocity(other) - v, weight * wet);
    }
    const float share = whole > 0 ? fit.weight / whole : 0;
    meeting[cell] = {share * fit.approach() / grid.frame.edge, 0, 0, value_measured};
  }
};

}  // namespace

template <class Bounds>
void find_meeting(MeetingCells& cells, MovingView water, const Bounds& bounds) {
  cells.sums.measure(water, nullptr, {{Whose::All, cells.grid}});
  for_each(
      "foam cells", cells.grid.cells(),
      MeetFoam<Bounds>{cells.sums.of(0), cells.grid, cells.last, cells.full, bounds, cells.meeting.data()});
}

template void find_meeting(MeetingCells&, MovingView, const Walls&);
template void find_meeting(MeetingCells&, MovingView, const Solids&);

}  // namespace sim::SIM_BACKEND
