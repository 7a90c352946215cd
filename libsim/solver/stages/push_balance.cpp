/// The coarse pressure is no pair force: interpolated between cells it gives the water momentum that nothing
/// gave. What it gave is measured against what the walls gave (Gauss' theorem on the cells), and the
/// difference is taken from all whom it pushed, alike.

#include "libsim/pressure/coarse_slope.hpp"
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
template <class Boundary>
struct SumWalls {
  PressureFrame frame;
  GridView grid;
  Boundary boundary;
  float unit_volume;  ///< of m_*, m3
  PushBalance* out;
  SIM_FN void operator()(int i) const {
    if (grid.kind[i] != CellKind::Fluid || grid.q[i] <= 0) return;
    MassWay sum{};
    const float push = grid.q[i] / unit_volume;
    for_wall_faces(frame, grid, boundary, i,
                   [&](int, Vec3 normal, float area) { sum.add(push * area, normal); });
    if (sum.x | sum.y | sum.z) out->walls.add_at_once(sum);
  }
};

/// What obstacles give: rho_0 grad q over the part of them that counts as water, and rho_0 q A beside the
/// part that is solid.
struct SumBodies {
  static constexpr int samples = 4;  ///< of a cell along an edge
  PressureFrame frame;
  GridView grid;
  Solids solids;
  BodyListener to;  ///< without sums nobody listens
  float unit_volume;
  PushBalance* out;

  SIM_FN void operator()(int i) const {
    if (grid.kind[i] != CellKind::Fluid) return;
    const CellBlock& block = grid.block;
    const int x = i % block.nx;
    const int y = i / block.nx % block.ny;
    const int z = i / (block.nx * block.ny);
    const Vec3 centre = middle_of(frame, x, y, z);
    int body;
    const float away = solids.nearest_body(centre, body);
    if (away > length(frame.edge)) return;
    const Vec3 e = frame.edge;
    const float inside = e.x * e.y * e.z * share(centre, away);
    const Vec3 beside{e.y * e.z * solid_sides(i, x, y, z, 1, 0, 0),
                      e.x * e.z * solid_sides(i, x, y, z, 0, 1, 0),
                      e.x * e.y * solid_sides(i, x, y, z, 0, 0, 1)};
    const Vec3 slope{rise(i, x, y, z, 1, 0, 0) / e.x, rise(i, x, y, z, 0, 1, 0) / e.y,
                     rise(i, x, y, z, 0, 0, 1) / e.z};
    const Vec3 push = (1 / unit_volume) * (inside * slope + beside);
    if (push.x == 0 && push.y == 0 && push.z == 0) return;
    MassWay sum{};
    sum.add(1, push);
    out->walls.add_at_once(sum);
    if (to.sums) to.add(body, centre, push);
  }
  /// Of the cell inside obstacles.
  SIM_FN float share(Vec3 centre, float away) const {
    const float reach = 0.5f * length(frame.edge);
    if (away > reach) return 0;
    if (away < -reach) return 1;
    int count = 0;
    for (int k = 0; k < samples * samples * samples; ++k) {
      const Vec3 at{offset(k % samples), offset(k / samples % samples), offset(k / (samples * samples))};
      count += solids.nearest_body(centre +
                                   Vec3{frame.edge.x * at.x, frame.edge.y * at.y, frame.edge.z * at.z}) < 0;
    }
    return static_cast<float>(count) / (samples * samples * samples);
  }
  SIM_FN static float offset(int k) { return (static_cast<float>(k) + 0.5f) / samples - 0.5f; }
  /// Change of q over the cell as its faces have it: none on one that is shut.
  SIM_FN float rise(int i, int x, int y, int z, int dx, int dy, int dz) const {
    float sum = 0;
    if (grid.kind_at(x + dx, y + dy, z + dz) != CellKind::Solid)
      sum += grid.q_at(x + dx, y + dy, z + dz) - grid.q[i];
    if (grid.kind_at(x - dx, y - dy, z - dz) != CellKind::Solid)
      sum += grid.q[i] - grid.q_at(x - dx, y - dy, z - dz);
    return 0.5f * sum;
  }
  /// q on the low side less q on the high side, where an obstacle's solid cells are.
  SIM_FN float solid_sides(int i, int x, int y, int z, int dx, int dy, int dz) const {
    float sum = 0;
    if (solid(x - dx, y - dy, z - dz)) sum += grid.q[i];
    if (solid(x + dx, y + dy, z + dz)) sum -= grid.q[i];
    return sum;
  }
  SIM_FN bool solid(int x, int y, int z) const {
    return grid.kind_at(x, y, z) == CellKind::Solid && body_has(solids, frame, grid, x, y, z);
  }
};

/// What bodies that may float give: the displaced water's weight in the field, up to the level beside them.
struct SumAfloat {
  static constexpr int samples = 4;
  CoarseSlope slope;
  Waterline waterline;
  BodyListener to;
  std::uint64_t* wet;  ///< ObstacleState::wet
  float unit_volume;
  PushBalance* out;

  SIM_FN void operator()(int i) const {
    const CellBlock& block = waterline.block;
    const int x = i % block.nx;
    const int y = i / block.nx % block.ny;
    const int z = i / (block.nx * block.ny);
    const Vec3 e = slope.frame.edge;
    const Vec3 centre = middle_of(slope.frame, x, y, z);
    const Solids& solids = waterline.solids;
    if (solids.nearest_body(centre) > 0.5f * length(e)) return;
    const float level = waterline.beside(x, y, z);
    if (level <= 0) return;
    const float share = e.x * e.y * e.z / (unit_volume * samples * samples * samples);
    for (int k = 0; k < samples * samples * samples; ++k) {
      const float up = SumBodies::offset(k / samples % samples);
      const Vec3 at = centre + Vec3{e.x * SumBodies::offset(k % samples), e.y * up,
                                    e.z * SumBodies::offset(k / (samples * samples))};
      int body;
      if (solids.nearest_body(at, body) >= 0) continue;
      // A sample is a layer of its own height, which the level may cut.
      const float below = at_most(at_least((level - 0.5f - up) * samples + 0.5f, 0.0f), 1.0f);
      if (below == 0) continue;
      atomic_add(&wet[body], static_cast<std::uint64_t>(below * share * CellWater::fixed_point));
      const Vec3 push = -(below * share) * slope.down(at);
      MassWay sum{};
      sum.add(1, push);
      out->walls.add_at_once(sum);
      if (to.sums) to.add(body, at, push);
    }
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
void sum_walls(FluidState& state, Boundary boundary) {
  auto& coarse = state.coarse;
  const GridView grid = coarse.multigrid.finest();
  for_each("sum walls", grid.block.size(),
           SumWalls<Boundary>{.frame = coarse.frame,
                              .grid = grid,
                              .boundary = boundary,
                              .unit_volume = mass_of(state.finest_support, 1),
                              .out = coarse.balance.data()});
}

void sum_bodies(FluidState& state) {
  auto& coarse = state.coarse;
  const GridView grid = coarse.multigrid.finest();
  if (state.obstacles.free.size() > 0) {
    state.obstacles.wet.zero();
    for_each("sum obstacles", grid.block.size(),
             SumAfloat{.slope = {coarse.frame, grid, state.walls},
                       .waterline = state.waterline(),
                       .to = state.body_listener(1),
                       .wet = state.obstacles.wet.data(),
                       .unit_volume = mass_of(state.finest_support, 1),
                       .out = coarse.balance.data()});
    return;
  }
  for_each("sum obstacles", grid.block.size(),
           SumBodies{.frame = coarse.frame,
                     .grid = grid,
                     .solids = state.solids(),
                     .to = state.body_listener(1),
                     .unit_volume = mass_of(state.finest_support, 1),
                     .out = coarse.balance.data()});
}

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
  const bool pressed = state.all_active || state.activation.rules.pressed;
  if (pressed) {
    for_each_team("sum push", (p.size() + run_length - 1) / run_length,
                  SumPush{.predicted = p.predicted(),
                          .next = p.predicted_next(),
                          .n = p.size(),
                          .finest_support = state.finest_support,
                          .out = coarse.balance.data()});
    state.obstacles.there() ? sum_walls(state, state.solids()) : sum_walls(state, state.walls);
  }
  if (state.obstacles.there() && (pressed || state.obstacles.free.size() > 0)) sum_bodies(state);
  state.obstacles.there() ? balance(state, p, state.solids()) : balance(state, p, state.walls);
  clamp_and_listen(state, p, p.predicted_next(), 1, true);
}

}  // namespace sim::SIM_BACKEND
