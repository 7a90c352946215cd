#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr float fixed_point = 1 << 20;
/// More than this is not compression but particles on top of each other, which the projections part.
constexpr float most_excess = 0.5f;

/// Adds each particle's volume and C V to its cell, in units of the smallest particle's volume. A particle
/// that is not solved brings a trace: it marks its cell as fluid and leaves the mean to the others.
template <class Selection>
struct Gather {
  Selection select;
  const Vec4* predicted;
  const float* density;
  const float* ease;  ///< of its constraint; nullptr where nothing splits or merges
  PressureFrame frame;
  CellBlock block;
  CellSum* sums;
  float unit_volume;

  SIM_FN void operator()(int i) const {
    const Vec4 p = predicted[i];
    const Vec3 at = frame.in_cells(xyz(p));
    const int x = static_cast<int>(floorf(at.x));
    const int y = static_cast<int>(floorf(at.y));
    const int z = static_cast<int>(floorf(at.z));
    if (!block.holds(x, y, z)) return;
    CellSum& sum = sums[block.index(x, y, z)];
    float volume = mass_of(p.w, 1) / unit_volume;
    float excess = at_most(at_least(density[i] - 1, -1.0f), most_excess);
    // Not much less: the cells are what keeps a whole tank that splits from getting too dense, and what they
    // leave for later comes back as speed.
    if (ease) excess *= 0.75f + 0.25f * ease[i];
    const auto fixed = [](float value) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(value * fixed_point));
    };
    if constexpr (!Selection::everyone) {
      if (select.moves(i) == 0) volume = 2 / fixed_point;
    }
    atomic_add(&sum.volume, fixed(volume));
    atomic_add(&sum.excess, fixed(volume * excess));
  }
};

/// A cell whose particles miss more than this share of the rest density on average holds a surface: q = 0
/// there. Left to the sign of q alone, the set of such cells swings from cycle to cycle.
constexpr float surface_deficit = 0.05f;

/// Turns sums into the equation: the source is the mean C of a cell's particles times the cell's volume.
struct Classify {
  PressureFrame frame;
  GridView grid;
  Walls walls;
  const CellSum* sums;

  SIM_FN void operator()(int i) const {
    const CellSum sum = sums[i];
    grid.source[i] = 0;
    if (sum.volume > 0) {
      const auto excess =
          static_cast<float>(static_cast<std::int64_t>(sum.excess)) / static_cast<float>(sum.volume);
      if (excess > -surface_deficit) {
        grid.kind[i] = CellKind::Fluid;
        grid.source[i] = frame.floor_area() * excess;
        return;
      }
    }
    const CellBlock& block = grid.block;
    const auto centre = [](int cell) { return static_cast<float>(cell) + 0.5f; };
    const Vec3 at{centre(i % block.nx), centre(i / block.nx % block.ny), centre(i / (block.nx * block.ny))};
    grid.kind[i] = walls.holds(frame.in_metres(at)) ? CellKind::Air : CellKind::Solid;
  }
};

/// The same with obstacles. Below the water's surface an obstacle's cells count as water at rest: its weight
/// is what the pressure beside it carries, and that is all that cells so wide can tell of it. The particles'
/// constraint keeps the water out. Cells that look out of the water are solid.
struct ClassifyRound {
  PressureFrame frame;
  GridView grid;
  Solids solids;
  const CellSum* sums;
  float unit_volume;

  SIM_FN void operator()(int i) const {
    const CellBlock& block = grid.block;
    const Vec3 at = middle_of(frame, i % block.nx, i / block.nx % block.ny, i / (block.nx * block.ny));
    grid.source[i] = 0;
    if (is_water(sums[i])) {
      grid.kind[i] = CellKind::Fluid;
      grid.source[i] = frame.floor_area() * filled(sums[i]) * mean_excess(sums[i]);
      return;
    }
    grid.kind[i] = solids.walls.holds(at) ? CellKind::Air : CellKind::Solid;
    int body;
    const float away = solids.nearest_body(at, body);
    const float wide = frame.edge.y;
    if (grid.kind[i] == CellKind::Solid || away > 0.5f * wide || sums[i].volume > 0) return;
    const Vec3 outside = at + (0.75f * wide - away) * solids.bodies[body].near(at).normal;
    const Vec3 there = frame.in_cells(outside);
    const int x = static_cast<int>(floorf(there.x));
    const int y = static_cast<int>(floorf(there.y));
    const int z = static_cast<int>(floorf(there.z));
    const bool wet = block.holds(x, y, z) && is_water(sums[block.index(x, y, z)]);
    if (wet || away < 0) grid.kind[i] = wet ? CellKind::Fluid : CellKind::Solid;
  }
  SIM_FN static float mean_excess(const CellSum& sum) {
    return static_cast<float>(static_cast<std::int64_t>(sum.excess)) / static_cast<float>(sum.volume);
  }
  SIM_FN static bool is_water(const CellSum& sum) {
    return sum.volume > 0 && mean_excess(sum) > -surface_deficit;
  }
  /// Share of the cell that its particles fill.
  SIM_FN float filled(const CellSum& sum) const {
    const float cell = frame.edge.x * frame.edge.y * frame.edge.z;
    return at_most(static_cast<float>(sum.volume) / fixed_point * unit_volume / cell, 1.0f);
  }
};

/// x_i -= grad q, interpolated from the faces that touch fluid, as a MAC grid's velocity would be. Before an
/// opening the outside is air, however small a part of the cell's face is open.
template <class Selection>
struct Shift {
  Selection select;
  const Vec4* predicted;
  Vec4* next;  ///< holds the places of those who are neither solved nor pressed
  PressureFrame frame;
  GridView grid;
  Walls walls;

  SIM_FN void operator()(int slot) const {
    int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0 && !select.others_pressed) return;
      if (i < 0) i = ~i;
    }
    const Vec4 p = predicted[i];
    const Vec3 at = frame.in_cells(xyz(p));
    Vec3 x = xyz(p);
    x += Vec3{along<1, 0, 0>(at, xyz(p)) / frame.edge.x, along<0, 1, 0>(at, xyz(p)) / frame.edge.y,
              along<0, 0, 1>(at, xyz(p)) / frame.edge.z};
    next[i] = with_w(x, p.w);
  }

  /// One component, edge times -dq/dx, of the field on the faces across (X, Y, Z).
  template <int X, int Y, int Z>
  SIM_FN float along(Vec3 at, Vec3 metres) const {
    // Face (x, y, z) lies between cell (x, y, z) - (X, Y, Z) and cell (x, y, z).
    const Vec3 local = at - Vec3{X ? 0 : 0.5f, Y ? 0 : 0.5f, Z ? 0 : 0.5f};
    const Vec3 base{floorf(local.x), floorf(local.y), floorf(local.z)};
    const Vec3 part = local - base;
    float weights = 0;
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int x = static_cast<int>(base.x) + (corner & 1);
      const int y = static_cast<int>(base.y) + (corner >> 1 & 1);
      const int z = static_cast<int>(base.z) + (corner >> 2);
      const float weight = (corner & 1 ? part.x : 1 - part.x) * (corner & 2 ? part.y : 1 - part.y) *
                           (corner & 4 ? part.z : 1 - part.z);
      const CellKind here = grid.kind_at(x, y, z);
      const CellKind before = grid.kind_at(x - X, y - Y, z - Z);
      if (here != CellKind::Fluid && before != CellKind::Fluid) continue;
      weights += weight;
      if (here == CellKind::Solid || before == CellKind::Solid) {
        const bool low = before == CellKind::Solid;
        if (!walls.opening_count ||
            !opens<X, Y, Z>(low ? Place{x - X, y - Y, z - Z} : Place{x, y, z}, low, metres))
          continue;
      }
      sum += weight * (grid.q_at(x - X, y - Y, z - Z) - grid.q_at(x, y, z));
    }
    return weights > 0 ? sum / weights : 0;
  }

  struct Place {
    int x, y, z;
  };
  /// Is this solid place outside the block, beyond an opening that the particle lies before?
  template <int X, int Y, int Z>
  SIM_FN bool opens(Place solid, bool low, Vec3 metres) const {
    if (grid.block.holds(solid.x, solid.y, solid.z)) return false;
    const float side = low ? 1.0f : -1.0f;
    for (int k = 0; k < walls.count; ++k) {
      if (dot(walls.planes[k].normal, Vec3{X, Y, Z}) == side && walls.opens(k, metres)) return true;
    }
    return false;
  }
};

/// Edge of the cells, for the particles that are there: those of a method that could hold finer ones would
/// hold too few of them to tell a mean. It goes by the mean mass in half levels, so that it changes rarely,
/// and leaves at least three cells across the tank where the lightest particles do.
float cell_edge(const FluidState& state) {
  const int n = state.particles.size();
  const float finest = state.parameters.coarse_edge * state.lightest_support;
  if (state.mass_units == 0 || n == 0) return finest;
  const float mean = static_cast<float>(state.mass_units) / static_cast<float>(n);
  const float half_levels = roundf(2 * log2f(at_least(mean, 1.0f)));
  const float wish = state.parameters.coarse_edge * state.finest_support * exp2f(half_levels / 6);
  const Vec3 size = state.domain.high - state.domain.low;
  const float across = at_most(size.x, at_most(size.y, size.z)) / 3;
  return at_least(finest, at_most(wish, across));
}

template <class Selection>
void launch(FluidState& state, CoarsePressureView p, Selection select) {
  auto& coarse = state.coarse;
  // While the water settles at one level, nobody has written the shares.
  const float* ease = state.one_level ? nullptr : p.ease();
  constrain_density(state, p);
  coarse.fit(state.domain, cell_edge(state));
  coarse.open(state.walls);
  const GridView grid = coarse.multigrid.finest();
  coarse.sums.zero();
  for_each("gather cells", p.size(),
           Gather<Selection>{.select = select,
                             .predicted = p.predicted(),
                             .density = p.density(),
                             .ease = ease,
                             .frame = coarse.frame,
                             .block = grid.block,
                             .sums = coarse.sums.data(),
                             .unit_volume = mass_of(state.lightest_support, 1)});
  if (state.obstacles.there()) {
    for_each("classify cells", grid.block.size(),
             ClassifyRound{.frame = coarse.frame,
                           .grid = grid,
                           .solids = state.solids(),
                           .sums = coarse.sums.data(),
                           .unit_volume = mass_of(state.lightest_support, 1)});
  } else {
    for_each("classify cells", grid.block.size(),
             Classify{coarse.frame, grid, state.walls, coarse.sums.data()});
  }
  coarse.multigrid.solve(state.parameters.coarse_cycles);
  for_each("shift", p.size(),
           Shift<Selection>{.select = select,
                            .predicted = p.predicted(),
                            .next = p.predicted_next(),
                            .frame = coarse.frame,
                            .grid = grid,
                            .walls = state.walls});
  balance_push(state, p);
}

void run(FluidState& state, CoarsePressureView p) { press(state, p); }

}  // namespace

void press(FluidState& state, CoarsePressureView p) {
  state.all_active ? launch(state, p, AllParticles{}) : launch(state, p, state.active());
}

Stage coarse_pressure_stage() {
  return stage_of<run>({.name = "coarse pressure",
                        .source = "multigrid on the fluid's cells",
                        .phase = Phase::Substep,
                        .called_for = [](const Demand& demand) -> std::string {
                          return demand.parameters.coarse_cycles > 0 ? "coarse cycles > 0" : "";
                        }});
}

}  // namespace sim::SIM_BACKEND
