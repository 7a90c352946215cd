#include "libsim/pressure/multigrid.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Place {
  int x, y, z;
};
SIM_FN Place place_of(const CellBlock& block, int i) {
  return {i % block.nx, i / block.nx % block.ny, i / (block.nx * block.ny)};
}

/// Links of the finest grid: 1 between fluid and fluid or air, 0 to what is solid. Above the block is air,
/// beside and below it are walls.
struct LinkFinest {
  CellBlock block;
  const CellKind* kind;
  Links* links;

  SIM_FN CellKind at(int x, int y, int z) const {
    if (block.holds(x, y, z)) return kind[block.index(x, y, z)];
    return y >= block.ny ? CellKind::Air : CellKind::Solid;
  }
  SIM_FN void operator()(int i) const {
    Links out{0, 0, 0, 0};
    if (kind[i] == CellKind::Fluid) {
      const Place p = place_of(block, i);
      const CellKind near[6] = {at(p.x + 1, p.y, p.z), at(p.x, p.y + 1, p.z), at(p.x, p.y, p.z + 1),
                                at(p.x - 1, p.y, p.z), at(p.x, p.y - 1, p.z), at(p.x, p.y, p.z - 1)};
      out.x = near[0] == CellKind::Fluid;
      out.y = near[1] == CellKind::Fluid;
      out.z = near[2] == CellKind::Fluid;
      for (const CellKind k : near) out.sum += k != CellKind::Solid;
    }
    links[i] = out;
  }
};

/// Links of a coarser grid: half the sum of the finer ones across each face, since the way is twice as long
/// (scaled Galerkin operator of piecewise constant aggregates; Braess 1995). The way to the air grows less:
/// the pressure is zero half a finest cell beyond the last face on every grid.
struct LinkCoarser {
  CellBlock fine, coarse;
  const Links* fine_links;
  Links* links;
  float to_air;

  SIM_FN void operator()(int i) const {
    const Place p = place_of(coarse, i);
    Links out{0, 0, 0, 0};
    float air = 0;
    for (int child = 0; child < 8; ++child) {
      const int x = 2 * p.x + (child & 1);
      const int y = 2 * p.y + (child >> 1 & 1);
      const int z = 2 * p.z + (child >> 2);
      if (!fine.holds(x, y, z)) continue;
      const int at = fine.index(x, y, z);
      const Links own = fine_links[at];
      const Links back{x > 0 ? fine_links[at - 1].x : 0.0f, y > 0 ? fine_links[at - fine.nx].y : 0.0f,
                       z > 0 ? fine_links[at - fine.nx * fine.ny].z : 0.0f, 0};
      air += fmaxf(own.sum - own.x - own.y - own.z - back.x - back.y - back.z, 0.0f);
      // A link between two children drops out of their sum.
      out.sum +=
          0.5f * ((child & 1 ? own.x : back.x) + (child & 2 ? own.y : back.y) + (child & 4 ? own.z : back.z));
      if (child & 1) out.x += 0.5f * own.x;
      if (child & 2) out.y += 0.5f * own.y;
      if (child & 4) out.z += 0.5f * own.z;
    }
    out.sum += to_air * air;
    links[i] = out;
  }
};

/// sum_j link_ij q_j
SIM_FN float pull(const LevelView& level, int i, Links own) {
  const CellBlock& b = level.block;
  const Place p = place_of(b, i);
  float out = 0;
  if (p.x + 1 < b.nx) out += own.x * level.q[i + 1];
  if (p.y + 1 < b.ny) out += own.y * level.q[i + b.nx];
  if (p.z + 1 < b.nz) out += own.z * level.q[i + b.nx * b.ny];
  if (p.x > 0) out += level.links[i - 1].x * level.q[i - 1];
  if (p.y > 0) out += level.links[i - b.nx].y * level.q[i - b.nx];
  if (p.z > 0) out += level.links[i - b.nx * b.ny].z * level.q[i - b.nx * b.ny];
  return out;
}

/// Gauss-Seidel on the cells of one colour; on the finest grid the pressure stays a push.
struct Smooth {
  LevelView level;
  int colour;
  bool push_only;
  SIM_FN void operator()(int i) const {
    const Links own = level.links[i];
    const Place p = place_of(level.block, i);
    if (((p.x + p.y + p.z) & 1) != colour || own.sum <= 0) return;
    const float q = (level.source[i] + pull(level, i, own)) / own.sum;
    level.q[i] = push_only ? fmaxf(q, 0.0f) : q;
  }
};

/// source of the coarser grid = sum of the finer residuals. Where a cell rests at q = 0 and wants to pull,
/// nothing is left to solve.
struct Restrict {
  LevelView fine, coarse;
  bool push_only;
  SIM_FN void operator()(int i) const {
    const Place p = place_of(coarse.block, i);
    float sum = 0;
    for (int child = 0; child < 8; ++child) {
      const int x = 2 * p.x + (child & 1);
      const int y = 2 * p.y + (child >> 1 & 1);
      const int z = 2 * p.z + (child >> 2);
      if (!fine.block.holds(x, y, z)) continue;
      const int at = fine.block.index(x, y, z);
      const Links own = fine.links[at];
      if (own.sum <= 0) continue;
      const float residual = fine.source[at] + pull(fine, at, own) - own.sum * fine.q[at];
      if (push_only && fine.q[at] <= 0 && residual < 0) continue;
      sum += residual;
    }
    coarse.source[i] = sum;
    coarse.q[i] = 0;
  }
};

/// Adds the coarser grid's correction, trilinear between the centres of cells that hold fluid.
struct Prolong {
  LevelView fine, coarse;
  bool push_only;
  SIM_FN void operator()(int i) const {
    if (fine.links[i].sum <= 0) return;
    const Place p = place_of(fine.block, i);
    const Place parent{p.x / 2, p.y / 2, p.z / 2};
    const Place beside{parent.x + (p.x & 1 ? 1 : -1), parent.y + (p.y & 1 ? 1 : -1),
                       parent.z + (p.z & 1 ? 1 : -1)};
    const float own = coarse.q[coarse.block.index(parent.x, parent.y, parent.z)];
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Place c{corner & 1 ? beside.x : parent.x, corner & 2 ? beside.y : parent.y,
                    corner & 4 ? beside.z : parent.z};
      const float weight =
          (corner & 1 ? 0.25f : 0.75f) * (corner & 2 ? 0.25f : 0.75f) * (corner & 4 ? 0.25f : 0.75f);
      const bool wall = c.x < 0 || c.y < 0 || c.z < 0 || c.x >= coarse.block.nx || c.z >= coarse.block.nz;
      float value = own;
      if (!wall) value = c.y < coarse.block.ny ? coarse.q[coarse.block.index(c.x, c.y, c.z)] : 0.0f;
      sum += weight * value;
    }
    const float q = fine.q[i] + sum;
    fine.q[i] = push_only ? fmaxf(q, 0.0f) : q;
  }
};

/// Conductance to the air of grid l, l >= 1, over that of the next finer one.
float to_air(std::size_t l) {
  const auto way = [](std::size_t grid) {
    return grid == 0 ? 1.0f : 0.5f + static_cast<float>(1 << (grid - 1));
  };
  return way(l - 1) / way(l);
}

/// The coarsest grid has at most this many cells along its longest side.
constexpr int coarsest_side = 2;
constexpr int coarsest_sweeps = 4;

}  // namespace

void Multigrid::fit(CellBlock finest) {
  if (!levels_.empty() && finest.nx == block().nx && finest.ny == block().ny && finest.nz == block().nz)
    return;
  levels_.clear();
  for (CellBlock block = finest;; block = block.halved()) {
    Level level;
    level.block = block;
    const auto size = static_cast<std::size_t>(block.size());
    level.links.resize(size);
    level.q.resize(size);
    level.source.resize(size);
    levels_.push_back(std::move(level));
    if (block.nx <= coarsest_side && block.ny <= coarsest_side && block.nz <= coarsest_side) break;
  }
  kind_.resize(static_cast<std::size_t>(finest.size()));
}

void Multigrid::link() {
  auto& finest = levels_.front();
  for_each("link cells", finest.block.size(), LinkFinest{finest.block, kind_.data(), finest.links.data()});
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    auto& fine = levels_[l - 1];
    auto& coarse = levels_[l];
    for_each("link coarser cells", coarse.block.size(),
             LinkCoarser{fine.block, coarse.block, fine.links.data(), coarse.links.data(), to_air(l)});
  }
}

void Multigrid::smooth(std::size_t level, std::array<int, 2> colours) {
  auto& at = levels_[level];
  for (const int colour : colours) for_each("smooth", at.block.size(), Smooth{at.view(), colour, level == 0});
}

void Multigrid::cycle(std::size_t level) {
  if (level + 1 == levels_.size()) {
    for (int sweep = 0; sweep < coarsest_sweeps; ++sweep) smooth(level, {0, 1});
    return;
  }
  auto& fine = levels_[level];
  auto& coarse = levels_[level + 1];
  smooth(level, {0, 1});
  for_each("restrict", coarse.block.size(), Restrict{fine.view(), coarse.view(), level == 0});
  cycle(level + 1);
  for_each("prolong", fine.block.size(), Prolong{fine.view(), coarse.view(), level == 0});
  smooth(level, {1, 0});
}

void Multigrid::solve(int cycles) {
  link();
  levels_.front().q.zero();
  for (int c = 0; c < cycles; ++c) cycle(0);
}

}  // namespace sim::SIM_BACKEND
