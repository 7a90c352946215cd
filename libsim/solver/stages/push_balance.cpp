/// The coarse pressure is no pair force: interpolated between cells it gives the water momentum that nothing
/// gave. What it gave is measured against what the walls gave (Gauss' theorem on the cells), and the
/// difference is taken from all whom it pushed, alike.

#include "libsim/pressure/grid_passes.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Particles that a team adds up, so that few meet at one sum.
constexpr int run_length = 64;

struct SumPush {
  const Vec4* predicted;
  const Vec4* next;
  int n;
  float finest_support;
  PushBalance* out;
  template <class Team>
  SIM_FN void operator()(int run, Team team) const {
    const int end = (run + 1) * run_length < n ? (run + 1) * run_length : n;
    MassWay pushed{};
    std::uint64_t mass = 0;
    for (int i = run * run_length + team.rank(); i < end; i += Team::size) {
      const Vec3 way = xyz(next[i]) - xyz(predicted[i]);
      if (way.x == 0 && way.y == 0 && way.z == 0) continue;
      const float units = rintf(mass_units_of(next[i].w, finest_support));
      pushed.add(units, way);
      mass += static_cast<std::uint64_t>(units);
    }
    pushed = {team.sum(pushed.x), team.sum(pushed.y), team.sum(pushed.z)};
    mass = team.sum(mass);
    if (team.rank() > 0 || mass == 0) return;
    out->pushed.add_at_once(pushed);
    atomic_add(&out->mass, mass);
  }
};

/// rho_0 q A of the cells at a wall along its normal: the sum of -rho_0 grad q over the water.
template <class Grid>
struct SumWalls {
  PressureFrame frame;
  Grid grid;
  float unit_volume;  ///< of m_*, m3
  PushBalance* out;
  SIM_FN void operator()(int i) const {
    if (grid.kind[i] != CellKind::Fluid || grid.q[i] <= 0) return;
    MassWay sum{};
    const float push = grid.q[i] / unit_volume;
    for_wall_faces(frame, grid, i, [&](int, Vec3 normal, float area) { sum.add(push * area, normal); });
    if (sum.x | sum.y | sum.z) out->walls.add_at_once(sum);
  }
};

/// The same of the faces that bodies shut, for the body that is nearest.
struct SumBodies {
  PressureFrame frame;
  CutView grid;
  Solids solids;
  BodyListener to;  ///< without sums nobody listens
  float unit_volume;
  PushBalance* out;
  SIM_FN void operator()(int i) const {
    if (grid.kind[i] != CellKind::Fluid || grid.q[i] <= 0) return;
    const Vec3 area = shut_by_bodies(frame, grid, i);
    if (area.x == 0 && area.y == 0 && area.z == 0) return;
    const Vec3 push = (grid.q[i] / unit_volume) * area;
    MassWay sum{};
    sum.add(1, push);
    out->walls.add_at_once(sum);
    if (!to.sums) return;
    const Place p = place_of(grid.block, i);
    const auto middle = [](int cell) { return static_cast<float>(cell) + 0.5f; };
    const Vec3 centre = frame.in_metres({middle(p.x), middle(p.y), middle(p.z)});
    int body;
    solids.nearest_body(centre, body);
    const Body::Near at = solids.bodies[body].near(centre);
    to.add(body, centre - at.distance * at.normal, push);
  }
};

template <class Boundary>
struct Balance {
  Vec4* predicted;
  Vec4* next;
  const PushBalance* balance;
  Boundary walls;
  Guards* guards;
  float wall_gap;
  bool listens;
  SIM_FN void operator()(int i) const {
    const Vec4 from = predicted[i];
    const Vec4 to = next[i];
    Vec3 x = xyz(to);
    if (x.x != from.x || x.y != from.y || x.z != from.z) x += balance->correction();
    if (walls.project(x, xyz(from), wall_gap * to.w / 2))
      atomic_add(&guards->wall_projected, std::uint64_t{1});
    predicted[i] = with_w(x, to.w);
    // A particle that no projection moves has its place in both buffers. Who listens asks whence it came
    // first.
    next[i] = listens ? from : predicted[i];
  }
};

template <class Boundary>
void balance(FluidState& state, ClampView p, Boundary boundary) {
  for_each("balance push", p.size(),
           Balance<Boundary>{.predicted = p.predicted(),
                             .next = p.predicted_next(),
                             .balance = state.coarse.balance.data(),
                             .walls = boundary,
                             .guards = state.guard(),
                             .wall_gap = gap_of_kernels(state),
                             .listens = state.listens()});
}

}  // namespace

void balance_push(FluidState& state, ClampView p) {
  auto& coarse = state.coarse;
  coarse.balance.resize(1);
  coarse.balance.zero();
  // Where those who are not solved are not pressed, their share of the walls' push reaches nobody.
  if (state.all_active || state.activation.rules.pressed) {
    for_each_team("sum push", (p.size() + run_length - 1) / run_length,
                  SumPush{.predicted = p.predicted(),
                          .next = p.predicted_next(),
                          .n = p.size(),
                          .finest_support = state.finest_support,
                          .out = coarse.balance.data()});
    const float unit_volume = mass_of(state.finest_support, 1);
    if (state.obstacles.there()) {
      const CutView grid = state.cut_grid();
      for_each("sum walls", grid.block.size(),
               SumWalls<CutView>{coarse.frame, grid, unit_volume, coarse.balance.data()});
      for_each("sum obstacles", grid.block.size(),
               SumBodies{.frame = coarse.frame,
                         .grid = grid,
                         .solids = state.solids(),
                         .to = state.body_listener(1),
                         .unit_volume = unit_volume,
                         .out = coarse.balance.data()});
    } else {
      const GridView grid = coarse.multigrid.finest();
      for_each("sum walls", grid.block.size(),
               SumWalls<GridView>{coarse.frame, grid, unit_volume, coarse.balance.data()});
    }
  }
  state.obstacles.there() ? balance(state, p, state.solids()) : balance(state, p, state.walls);
  clamp_and_listen(state, p, p.predicted_next(), 1, true);
}

}  // namespace sim::SIM_BACKEND
