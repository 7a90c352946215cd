/// The coarse pressure is no pair force: interpolated between cells it gives the water momentum that nothing
/// gave. What it gave is measured against what the walls gave (Gauss' theorem on the cells), and the
/// difference is taken from all whom it pushed, alike.

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
struct SumWalls {
  PressureFrame frame;
  GridView grid;
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

struct Balance {
  Vec4* predicted;
  Vec4* next;
  const PushBalance* balance;
  Walls walls;
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
    const GridView grid = coarse.multigrid.finest();
    for_each("sum walls", grid.block.size(),
             SumWalls{coarse.frame, grid, mass_of(state.finest_support, 1), coarse.balance.data()});
  }
  for_each("balance push", p.size(),
           Balance{.predicted = p.predicted(),
                   .next = p.predicted_next(),
                   .balance = coarse.balance.data(),
                   .walls = state.walls,
                   .guards = state.guard(),
                   .wall_gap = gap_of_kernels(state),
                   .listens = state.impulse.listens()});
  clamp_and_listen(state, p, p.predicted_next(), 1, true);
}

}  // namespace sim::SIM_BACKEND
