/// The coarse pressure is not a pair force: interpolation between cells adds spurious momentum to the water.
/// Its push is compared with that of the walls (Gauss' theorem on the cells), and the difference is
/// subtracted equally from all pushed particles.

#include "libsim/pressure/coarse_slope.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Number of particles that a team sums before it adds to the total, so that fewer teams contend for the
/// total.
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

/// Sums rho_0 q A over the cells at walls, along the wall's normal, with q the coarse pressure and A the area
/// of the cell's face on the wall. By Gauss' theorem, the sum for walls and bodies together equals the sum of
/// -rho_0 grad q over the water.
template <class Boundary>
struct SumWalls {
  PressureFrame frame;
  GridView grid;
  Boundary boundary;
  float unit_volume;  ///< volume of a particle of level 0, m3
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

/// Sums the push of obstacles: -rho_0 grad q over the volume of water that they displace, up to the water
/// level beside them, and rho_0 q A at their solid cells, with the coarse pressure q and the area A of a
/// cell's face.
struct SumBodies {
  static constexpr int samples = 4;  ///< samples along a cell's edge
  CoarseSlope slope;
  Waterline waterline;
  BodyListener to;     ///< records the bodies' pushes on the water, unless its `sums` is nullptr
  std::uint64_t* wet;  ///< volume of each body below the water level (ObstacleState::wet)
  float unit_volume;
  PushBalance* out;

  /// Number of lanes per cell: few cells contain a body, but each of these needs much work.
  int lanes(int) const { return 8; }

  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const CellBlock& block = waterline.block;
    const int x = i % block.nx;
    const int y = i / block.nx % block.ny;
    const int z = i / (block.nx * block.ny);
    const Vec3 e = slope.frame.edge;
    const Vec3 centre = middle_of(slope.frame, x, y, z);
    const Solids& solids = waterline.solids;
    int nearest;
    const float away = solids.nearest_body(centre, nearest);
    if (away > length(e)) return;
    if (slope.grid.kind[i] == CellKind::Fluid && team.rank() == 0) {
      const Vec3 held = (slope.grid.q[i] / unit_volume) * solid_sides(x, y, z);
      if (held.x != 0 || held.y != 0 || held.z != 0) {
        Given given{.body = nearest};
        add(given, centre, held);
        tell(given);
      }
    }
    // The push of a solid cell is counted at its neighbours' faces.
    if (away > 0.5f * length(e) || solid(x, y, z) > 0) return;
    const float level = waterline.beside(x, y, z).mean;
    if (level <= 0) return;
    const float share = e.x * e.y * e.z / (unit_volume * samples * samples * samples);
    Given given{};
    for (int k = team.rank(); k < samples * samples * samples; k += Team::size) {
      const Vec3 from{offset(k % samples), offset(k / samples % samples), offset(k / (samples * samples))};
      const Vec3 at = centre + Vec3{e.x * from.x, e.y * from.y, e.z * from.z};
      const float up = dot(waterline.up, from);
      int body;
      if (solids.nearest_body(at, body) >= 0) continue;
      // A sample represents a layer as high as the distance between samples; the water level may cut this
      // layer.
      const float below = at_most(at_least((level - 0.5f - up) * samples + 0.5f, 0.0f), 1.0f);
      if (below == 0) continue;
      if (body != given.body) {
        tell(given);
        given = {.body = body};
      }
      given.wet += static_cast<std::uint64_t>(below * share * CellWater::fixed_point);
      add(given, at, -(below * share) * slope.down(at));
    }
    for (int body = 0; body < solids.count; ++body) {
      if (team.any(given.body == body)) tell_together(given.body == body ? given : Given{.body = body}, team);
    }
  }

  /// Sums of one cell for one body, so that the cell adds to the body's totals only once.
  struct Given {
    int body = -1;
    MassWay push{};
    BodySum record{};
    std::uint64_t wet = 0;
  };
  SIM_FN void add(Given& given, Vec3 at, Vec3 push) const {
    given.push.add(1, push);
    if (to.sums) to.add_to(given.record, given.body, at, push);
  }
  template <class Team>
  SIM_FN void tell_together(const Given& mine, Team team) const {
    const auto sum = [&](const MassWay& way) {
      return MassWay{team.sum(way.x), team.sum(way.y), team.sum(way.z)};
    };
    Given all{.body = mine.body, .push = sum(mine.push)};
    if (to.sums) all.record = {sum(mine.record.push), sum(mine.record.moment)};
    all.wet = team.sum(mine.wet);
    if (team.rank() == 0) tell(all);
  }
  SIM_FN void tell(const Given& given) const {
    if (given.body < 0) return;
    out->walls.add_at_once(given.push);
    if (given.wet > 0) atomic_add(&wet[given.body], given.wet);
    if (to.sums) to.add_at_once(given.body, given.record);
  }
  /// Sum over the cell's faces towards solid cells of obstacles: the face's area, m2, times the unit vector
  /// out of the solid cell.
  SIM_FN Vec3 solid_sides(int x, int y, int z) const {
    const Vec3 e = slope.frame.edge;
    return {e.y * e.z * (solid(x - 1, y, z) - solid(x + 1, y, z)),
            e.x * e.z * (solid(x, y - 1, z) - solid(x, y + 1, z)),
            e.x * e.y * (solid(x, y, z - 1) - solid(x, y, z + 1))};
  }
  SIM_FN float solid(int x, int y, int z) const {
    const bool held = slope.grid.kind_at(x, y, z) == CellKind::Solid &&
                      body_has(waterline.solids, slope.frame, slope.grid, x, y, z);
    return held ? 1.0f : 0.0f;
  }
  SIM_FN static float offset(int k) { return (static_cast<float>(k) + 0.5f) / samples - 0.5f; }
};

template <class Boundary>
struct Balance {
  Vec4* predicted;
  Vec4* next;
  const PushBalance* balance;
  Boundary walls;
  Guards* guards;
  float wall_gap;
  bool recording;
  SIM_FN void operator()(int i) const {
    const Vec4 from = predicted[i];
    const Vec4 to = next[i];
    Vec3 x = xyz(to);
    if (x.x != from.x || x.y != from.y || x.z != from.z) x += balance->correction();
    if (walls.project(x, xyz(from), wall_gap * to.w / 2))
      atomic_add(&guards->wall_projected, std::uint64_t{1});
    predicted[i] = with_w(x, to.w);
    // Both buffers need the same position, for particles that no projection moves. While recording, `next`
    // first keeps the old position, which clamp_and_listen needs.
    next[i] = recording ? from : predicted[i];
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
  state.obstacles.wet.zero();
  for_each_team("sum obstacles", grid.block.size(),
                SumBodies{.slope = {coarse.frame, grid, state.walls},
                          .waterline = state.waterline(),
                          .to = state.body_record(1),
                          .wet = state.obstacles.wet.data(),
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
                             .recording = state.recording()});
}

}  // namespace

void balance_push(FluidState& state, ClampView p) {
  auto& coarse = state.coarse;
  coarse.balance.resize(1);
  coarse.balance.zero();
  // In a frame with whole-frame rests, unsolved particles do not move with the coarse pressure.
  // PushBalance::mass then stays 0, so that no particle is corrected.
  const bool pressed = state.all_active || state.activation.rules.within_frame;
  if (pressed) {
    for_each_team("sum push", (p.size() + run_length - 1) / run_length,
                  SumPush{.predicted = p.predicted(),
                          .next = p.predicted_next(),
                          .n = p.size(),
                          .finest_support = state.finest_support,
                          .out = coarse.balance.data()});
    state.obstacles.exists() ? sum_walls(state, state.solids()) : sum_walls(state, state.walls);
  }
  if (state.obstacles.exists() && (pressed || state.obstacles.free.size() > 0)) sum_bodies(state);
  state.obstacles.exists() ? balance(state, p, state.solids()) : balance(state, p, state.walls);
  clamp_and_listen(state, p, p.predicted_next(), 1, true);
}

}  // namespace sim::SIM_BACKEND
