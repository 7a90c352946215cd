#include "libsim/pressure/coarse_slope.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr float fixed_point = CellWater::fixed_point;
/// Upper bound of rho / rho_0 - 1. Higher values come from overlapping particles, which the projections
/// separate, and not from compression.
constexpr float most_excess = 0.5f;

/// Adds to each particle's cell its volume V, and C V with the excess C = rho / rho_0 - 1, in units of the
/// smallest particle's volume. An unsolved particle adds a tiny amount: it marks its cell as fluid and hardly
/// affects the mean.
template <class Selection>
struct Gather {
  Selection select;
  const Vec4* predicted;
  const float* density;
  const float* ease;  ///< share of its density constraint that a particle enforces, (0, 1]; nullptr if
                      ///< nothing splits or merges
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
    // Near particles that split or merged recently, the excess is reduced by at most a quarter. A larger
    // reduction is not possible: the pressure on cells must limit the density of a tank in which all
    // particles split, because remaining compression would later become speed.
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

/// Adds all particles' volumes to their cells, solved or not.
struct GatherVolume {
  const Vec4* predicted;
  PressureFrame frame;
  CellBlock block;
  std::uint64_t* volume;
  float unit_volume;

  SIM_FN void operator()(int i) const {
    const Vec3 at = frame.in_cells(xyz(predicted[i]));
    const int x = static_cast<int>(floorf(at.x));
    const int y = static_cast<int>(floorf(at.y));
    const int z = static_cast<int>(floorf(at.z));
    if (!block.holds(x, y, z)) return;
    const float own = mass_of(predicted[i].w, 1) / unit_volume;
    atomic_add(&volume[block.index(x, y, z)], static_cast<std::uint64_t>(own * fixed_point));
  }
};

/// Sets kind and source of each cell from its sums. The source is the mean of rho / rho_0 - 1 over the cell's
/// particles, by volume, times the cell's floor area (PressureFrame::floor_area).
struct Classify {
  PressureFrame frame;
  GridView grid;
  Walls walls;
  const CellSum* sums;

  SIM_FN void operator()(int i) const {
    const CellSum sum = sums[i];
    grid.source[i] = 0;
    if (CellWater::is_water(sum)) {
      grid.kind[i] = CellKind::Fluid;
      grid.source[i] = frame.floor_area() * CellWater::mean_excess(sum);
      return;
    }
    const CellBlock& block = grid.block;
    const Vec3 at = middle_of(frame, i % block.nx, i / block.nx % block.ny, i / (block.nx * block.ny));
    grid.kind[i] = walls.holds(at) ? CellKind::Air : CellKind::Solid;
  }
};

/// Sets kind and source of each cell in scenes with obstacles. A cell without particles, in or next to an
/// obstacle, counts as water at rest if the mean water level beside the obstacle is above the cell's middle,
/// as solid if the water on some side is above the whole cell, and otherwise as air. The pressure of the
/// cells beside the obstacle then supports the weight of the displaced water. The cells are too wide for more
/// detail. The particles' density constraint keeps water out of the obstacle.
struct ClassifyRound {
  PressureFrame frame;
  GridView grid;
  Waterline waterline;
  const CellSum* sums;

  SIM_FN void operator()(int i) const {
    const CellBlock& block = grid.block;
    const int x = i % block.nx;
    const int y = i / block.nx % block.ny;
    const int z = i / (block.nx * block.ny);
    const CellSum sum = sums[i];
    grid.source[i] = 0;
    if (CellWater::is_water(sum)) {
      grid.kind[i] = CellKind::Fluid;
      grid.source[i] = frame.floor_area() * waterline.water.filled(sum.volume) * CellWater::mean_excess(sum);
      return;
    }
    const Vec3 at = middle_of(frame, x, y, z);
    grid.kind[i] = waterline.solids.walls.holds(at) ? CellKind::Air : CellKind::Solid;
    if (grid.kind[i] == CellKind::Solid || sum.volume > 0) return;
    if (waterline.solids.nearest_body(at) > 0.5f * waterline.pitch()) return;
    const LevelBeside level = waterline.beside(x, y, z);
    if (level.mean > 0.5f) grid.kind[i] = CellKind::Fluid;
    // If the cells of an obstacle between water and dry space were air, the water would flow into them.
    else if (level.most == 1)
      grid.kind[i] = CellKind::Solid;
  }
};

/// Moves particles by the coarse pressure q: x_i -= grad q.
template <class Selection>
struct Shift {
  Selection select;
  const Vec4* predicted;
  Vec4* next;  ///< not written for particles that are neither solved nor moved by the coarse pressure
  CoarseSlope slope;

  SIM_FN void operator()(int slot) const {
    int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0 && !select.others_pressed) return;
      if (i < 0) i = ~i;
    }
    const Vec4 p = predicted[i];
    Vec3 x = xyz(p);
    x += slope.down(xyz(p));
    next[i] = with_w(x, p.w);
  }
};

/// Edge of the cells for the present particles, m. Cells sized for the method's finest particles would
/// contain too few coarser particles for a mean. So the edge follows the particles' mean mass, rounded to
/// half levels, so that it rarely changes. At least three cells span the tank's shortest side, unless the
/// cells for the lightest particles are wider.
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
  // While the water settles, all particles have one level and the column Ease is not written.
  const float* ease = state.one_level ? nullptr : p.ease();
  constrain_density(state, p);
  coarse.fit(state.domain, cell_edge(state), state.walls.have_lid());
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
  if (state.obstacles.exists()) {
    coarse.volume.resize(coarse.sums.size());
    coarse.volume.zero();
    for_each("gather volume", p.size(),
             GatherVolume{.predicted = p.predicted(),
                          .frame = coarse.frame,
                          .block = grid.block,
                          .volume = coarse.volume.data(),
                          .unit_volume = mass_of(state.lightest_support, 1)});
    for_each("classify cells", grid.block.size(),
             ClassifyRound{coarse.frame, grid, state.waterline(), coarse.sums.data()});
  } else {
    for_each("classify cells", grid.block.size(),
             Classify{coarse.frame, grid, state.walls, coarse.sums.data()});
  }
  coarse.multigrid.solve(state.parameters.coarse_cycles);
  for_each("shift", p.size(),
           Shift<Selection>{.select = select,
                            .predicted = p.predicted(),
                            .next = p.predicted_next(),
                            .slope = {coarse.frame, grid, state.walls}});
  balance_push(state, p);
}

void run_coarse_pressure(FluidState& state, CoarsePressureView p) { press(state, p); }

}  // namespace

void press(FluidState& state, CoarsePressureView p) {
  state.all_active ? launch(state, p, AllParticles{}) : launch(state, p, state.active());
}

Stage coarse_pressure_stage() {
  return stage_of<run_coarse_pressure>({.name = "coarse pressure",
                                        .source = "multigrid on the fluid's cells",
                                        .phase = Phase::Substep,
                                        .called_for = [](const Demand& demand) -> std::string {
                                          return demand.parameters.coarse_cycles > 0 ? "coarse cycles > 0"
                                                                                     : "";
                                        }});
}

}  // namespace sim::SIM_BACKEND
