/// Passes that record the momentum that walls and obstacles give the water (libsim/impulse).

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Records for corrections of a particle by walls and, in scenes with obstacles, by bodies.
struct Records {
  WallRecord walls;
  bool walls_recorded;
  BodyListener bodies;
};
struct RecordBoth {
  Records to;
  Vec4 particle;
  SIM_FN void operator()(int wall, float way) const {
    if (to.walls_recorded) RecordClamp{to.walls, particle}(wall, way);
  }
  SIM_FN void body(int which, Vec3 at, Vec3 way) const {
    to.bodies.add(which, with_w(at, particle.w), at,
                  mass_units_of(particle.w, to.bodies.finest_support) * way);
  }
};
SIM_FN RecordClamp record_of(const WallRecord& to, Vec4 particle) { return {to, particle}; }
SIM_FN RecordBoth record_of(const Records& to, Vec4 particle) { return {to, particle}; }

/// The same record for a push whose displacement counts as velocity over this number of substeps
/// (FluidState::time_of_rest).
SIM_FN WallRecord over(WallRecord to, float substeps) {
  to.times /= substeps;
  return to;
}
SIM_FN Records over(Records to, float substeps) {
  to.walls.times /= substeps;
  to.bodies.times /= substeps;
  return to;
}

Records records(FluidState& state, float times) {
  return {state.impulse.record_to(times), state.impulse.on(), state.body_record(times)};
}

/// Repeats how Predict holds particles back at walls, in order to record the momentum.
template <class Boundary, class Recorder>
struct HeldBack {
  const Vec4* position;
  const Vec4* velocity;
  Boundary walls;
  Recorder to;
  float dt, wall_gap;
  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    Vec3 x = xyz(at);
    walls.hold_back(x, fused(x, dt, xyz(velocity[i])), wall_gap * at.w / 2, record_of(to, at));
  }
};

using MovingView = Reads<Column::Position, Column::Velocity>;

template <class Boundary, class Recorder>
void held_back(FluidState& state, MovingView p, Boundary boundary, Recorder to) {
  for_each("record held back", p.size(),
           HeldBack<Boundary, Recorder>{.position = p.position(),
                                        .velocity = p.velocity(),
                                        .walls = boundary,
                                        .to = to,
                                        .dt = state.parameters.dt,
                                        .wall_gap = state.parameters.wall_gap});
}

/// Sums, for each patch, the wetted area: a square of side d for each particle beside the patch.
struct Wetted {
  const Vec4* position;
  Solids solids;
  BodyPatches patches;
  float finest_support;
  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    const float size = at.w / finest_support;
    for (int b = 0; b < solids.count; ++b) {
      if (solids.distance(b, xyz(at)) >= at.w) continue;
      patches.at(solids.bodies[b], b, xyz(at), 0.5f * at.w, [&](PatchSum& patch, float share) {
        atomic_add(&patch.wet, static_cast<std::uint64_t>(share * size * size * CellWater::fixed_point));
      });
    }
  }
};

void record_held_back(FluidState& state, MovingView p) {
  state.obstacles.exists() ? held_back(state, p, state.solids(), records(state, 1))
                           : held_back(state, p, state.walls, state.impulse.record_to());
  if (state.obstacles.patches.size() == 0) return;
  for_each("record wetted patches", p.size(),
           Wetted{p.position(), state.solids(), state.obstacles.listening_patches(), state.finest_support});
}

/// Factor on the missing density at walls: the share of the kernel outside all bodies, because bodies at the
/// wall reduce the walls' part. 1 in scenes without obstacles.
SIM_FN float beside_bodies(const Walls&, Vec3, float) { return 1; }
SIM_FN float beside_bodies(const Solids& solids, Vec3 x, float h) { return solids.beside_bodies(x, h); }

/// Records, for each wall, its part of the next displacement: Delta p_i = w_i lambda_i grad_i C_wall, with w
/// = 1 / m and C_wall the wall's part of the kernel's share behind walls and obstacles.
template <class Boundary>
struct MissingDensity {
  const Vec4* predicted;
  const float* lambda;
  Boundary boundary;
  WallRecord to;
  TimeOfRest time;
  float mass_unit;  ///< mass of a particle of level 0, kg
  SIM_FN void operator()(int i) const {
    if (lambda[i] == 0) return;
    const Vec4 at = predicted[i];
    const Walls& walls = tank(boundary);
    const float present = beside_bodies(boundary, xyz(at), at.w);
    for (int k = 0; k < walls.count; ++k) {
      const float slope = present * walls.missing_slope(k, xyz(at), at.w);
      if (slope != 0)
        over(to, time(i)).add(k, WallPart::MissingDensity, xyz(at), at.w, lambda[i] * slope / mass_unit);
    }
  }
};

/// Records, for each body, its part of the next displacement: Delta p_i = w_i lambda_i grad_i C_body, with w
/// = 1 / m and C_body the body's part of the kernel's share behind walls and obstacles.
struct MissingInBodies {
  const Vec4* predicted;
  const float* lambda;
  Solids solids;
  BodyListener to;
  TimeOfRest time;
  float mass_unit;
  SIM_FN void operator()(int i) const {
    if (lambda[i] == 0) return;
    const Vec4 at = predicted[i];
    for (int b = 0; b < solids.count; ++b) {
      const Body::Near near = solids.near(b, xyz(at));
      if (near.distance >= at.w) continue;
      const Vec3 gradient = solids.missing_gradient(b, xyz(at), at.w);
      to.add(b, at, xyz(at) - near.distance * near.normal, (lambda[i] / (mass_unit * time(i))) * gradient);
    }
  }
};

using ConstraintView = Reads<Column::Predicted, Column::Lambda>;

template <class Boundary>
void missing_density(FluidState& state, ConstraintView p, Boundary boundary) {
  const auto& k = state.parameters;
  for_each("record missing density", p.size(),
           MissingDensity<Boundary>{.predicted = p.predicted(),
                                    .lambda = p.lambda(),
                                    .boundary = boundary,
                                    .to = state.impulse.record_to(times_taken(k, state.iteration)),
                                    .time = state.time_of_rest(),
                                    .mass_unit = mass_of(state.finest_support, k.rest_density)});
}
void record_missing_density(FluidState& state, ConstraintView p) {
  if (!state.obstacles.exists()) return missing_density(state, p, state.walls);
  if (state.impulse.on()) missing_density(state, p, state.solids());
  const auto& k = state.parameters;
  for_each("record missing in obstacles", p.size(),
           MissingInBodies{.predicted = p.predicted(),
                           .lambda = p.lambda(),
                           .solids = state.solids(),
                           .to = state.body_record(times_taken(k, state.iteration)),
                           .time = state.time_of_rest(),
                           .mass_unit = mass_of(state.finest_support, k.rest_density)});
}

/// Records the push on each wall by the coarse pressure q of the cells at the wall. A pressure gauge may be
/// smaller than a cell. So each face of a cell is divided into patches, and q varies linearly over them
/// towards the neighbouring cells. The sum over the patches is the push on the face as push_balance.cpp
/// counts it.
template <class Boundary>
struct WallCells {
  PressureFrame frame;
  GridView grid;
  Boundary boundary;
  WallRecord to;
  float unit_volume;  ///< volume of a particle of level 0, m3

  SIM_FN void operator()(int i) const {
    if (grid.kind[i] != CellKind::Fluid || grid.q[i] <= 0) return;
    const CellBlock& block = grid.block;
    const int x = i % block.nx;
    const int y = i / block.nx % block.ny;
    const int z = i / (block.nx * block.ny);
    const auto middle = [](int cell) { return static_cast<float>(cell) + 0.5f; };
    const Vec3 centre{middle(x), middle(y), middle(z)};
    const float q = grid.q[i];
    const Vec3 slope{slope_of(q, x, y, z, 1, 0, 0), slope_of(q, x, y, z, 0, 1, 0),
                     slope_of(q, x, y, z, 0, 0, 1)};
    for_wall_faces(frame, grid, boundary, i, [&](int wall, Vec3 normal, float area) {
      const float share = area / (unit_volume * patches * patches);
      for (int a = 0; a < patches; ++a) {
        for (int b = 0; b < patches; ++b) {
          const float first = middle(a) / patches - 0.5f;
          const float second = middle(b) / patches - 0.5f;
          // Offset of the patch from the cell's centre, in cells; 0 across the wall.
          const Vec3 from = normal.x != 0   ? Vec3{0, first, second}
                            : normal.y != 0 ? Vec3{first, 0, second}
                                            : Vec3{first, second, 0};
          to.add(wall, WallPart::CoarsePressure, frame.in_metres(centre + from),
                 (0.5f / patches) * frame.edge, (q + dot(slope, from)) * share);
        }
      }
    });
  }
  /// Change of q along one axis over the cell, limited so that along this axis q does not fall below 0.
  SIM_FN float slope_of(float q, int x, int y, int z, int dx, int dy, int dz) const {
    const float before = q_beside(q, x - dx, y - dy, z - dz);
    const float after = q_beside(q, x + dx, y + dy, z + dz);
    return fminf(fmaxf((after - before) / 2, -2 * q), 2 * q);
  }
  SIM_FN float q_beside(float q, int x, int y, int z) const {
    return grid.kind_at(x, y, z) == CellKind::Solid ? q : grid.q_at(x, y, z);
  }
  static constexpr int patches = 4;
};

/// Records the push of the coarse pressure q on the patches of bodies: rho_0 q A for each face, of area A,
/// between a sample inside and one outside a body. The push on the whole body in push_balance.cpp differs
/// slightly; count_obstacles distributes the difference.
struct BodyCells {
  PressureFrame frame;
  GridView grid;
  Solids solids;
  BodyListener to;
  float unit_volume;
  static constexpr int samples = 4;  ///< samples along a cell's edge

  SIM_FN void operator()(int i) const {
    const CellBlock& block = grid.block;
    const int x = i % block.nx, y = i / block.nx % block.ny, z = i / (block.nx * block.ny);
    const Vec3 e = frame.edge, centre = middle_of(frame, x, y, z);
    if (solids.nearest_body(centre) > length(e)) return;
    for (int k = 0; k < samples * samples * samples; ++k) {
      const Vec3 at = centre + Vec3{e.x * offset(k % samples), e.y * offset(k / samples % samples),
                                    e.z * offset(k / (samples * samples))};
      int body;
      if (solids.nearest_body(at, body) >= 0) continue;
      for (int side = -1; side <= 1; side += 2) {
        const auto way = static_cast<float>(side);
        face(body, at, {way, 0, 0}, e.x, e.y * e.z);
        face(body, at, {0, way, 0}, e.y, e.x * e.z);
        face(body, at, {0, 0, way}, e.z, e.x * e.y);
      }
    }
  }
  SIM_FN void face(int body, Vec3 inside, Vec3 out, float edge, float cell_face) const {
    const Vec3 beside = inside + (edge / samples) * out;
    if (!solids.holds(beside)) return;
    const Vec3 at = 0.5f * (inside + beside);
    const float q = pressure(beside);
    if (q <= 0) return;
    const float area = cell_face / (samples * samples);
    to.add_to_patches(body, at, sqrtf(area), at, (q * area / unit_volume) * out);
  }
  /// q interpolated between the centres of cells; solid cells are left out.
  SIM_FN float pressure(Vec3 place) const {
    const Vec3 local = frame.in_cells(place) - Vec3{0.5f, 0.5f, 0.5f};
    const Vec3 base{floorf(local.x), floorf(local.y), floorf(local.z)};
    const Vec3 part = local - base;
    float weights = 0, sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int x = static_cast<int>(base.x) + (corner & 1);
      const int y = static_cast<int>(base.y) + (corner >> 1 & 1);
      const int z = static_cast<int>(base.z) + (corner >> 2);
      if (grid.kind_at(x, y, z) == CellKind::Solid) continue;
      const float weight = (corner & 1 ? part.x : 1 - part.x) * (corner & 2 ? part.y : 1 - part.y) *
                           (corner & 4 ? part.z : 1 - part.z);
      weights += weight;
      sum += weight * grid.q_at(x, y, z);
    }
    return weights > 0 ? sum / weights : 0;
  }
  SIM_FN static float offset(int k) { return (static_cast<float>(k) + 0.5f) / samples - 0.5f; }
};

template <class Boundary>
void wall_cells(FluidState& state, Boundary boundary) {
  const GridView grid = state.coarse.multigrid.finest();
  for_each("record wall cells", grid.block.size(),
           WallCells<Boundary>{.frame = state.coarse.frame,
                               .grid = grid,
                               .boundary = boundary,
                               .to = state.impulse.record_to(),
                               .unit_volume = mass_of(state.finest_support, 1)});
}
void record_wall_cells(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  state.obstacles.exists() ? wall_cells(state, state.solids()) : wall_cells(state, state.walls);
  if (state.obstacles.patches.size() == 0) return;
  const GridView grid = state.coarse.multigrid.finest();
  for_each("record obstacles' cells", grid.block.size(),
           BodyCells{.frame = state.coarse.frame,
                     .grid = grid,
                     .solids = state.solids(),
                     .to = state.body_record(1),
                     .unit_volume = mass_of(state.finest_support, 1)});
}

template <class Boundary, class Recorder>
struct Clamp {
  Vec4* predicted;
  const Vec4* from;
  Vec4* next;  ///< nullptr if PredictedNext must not change
  Boundary walls;
  Recorder to;
  TimeOfRest time;
  Guards* guards;
  float wall_gap;
  SIM_FN void operator()(int i) const {
    const Vec4 at = predicted[i];
    Vec3 x = xyz(at);
    if (walls.project(x, xyz(from[i]), wall_gap * at.w / 2, record_of(over(to, time(i)), at))) {
      atomic_add(&guards->wall_projected, std::uint64_t{1});
      predicted[i] = with_w(x, at.w);
    }
    if (next) next[i] = predicted[i];
  }
};

template <class Boundary, class Recorder>
void clamp(FluidState& state, ClampView p, const Vec4* from, bool in_both, Boundary boundary, Recorder to) {
  for_each("clamp and record", p.size(),
           Clamp<Boundary, Recorder>{
               .predicted = p.predicted(),
               .from = from,
               .next = in_both ? p.predicted_next() : nullptr,
               .walls = boundary,
               .to = to,
               // A projection, unless it is the coarse pressure, which acts in every substep.
               .time = in_both ? TimeOfRest{} : state.time_of_rest(),
               .guards = state.guard(),
               .wall_gap = state.parameters.wall_gap});
}

Stage account(const char* name, Phase phase) {
  return {.name = name, .source = "what the walls give the water", .phase = phase, .called_for = if_pushes};
}

}  // namespace

float gap_of_kernels(const FluidState& state) {
  constexpr float none = -1e30f;
  return state.recording() ? none : state.parameters.wall_gap;
}

void clamp_and_listen(FluidState& state, ClampView p, const Vec4* from, float times, bool in_both) {
  if (!state.recording()) return;
  state.obstacles.exists() ? clamp(state, p, from, in_both, state.solids(), records(state, times))
                           : clamp(state, p, from, in_both, state.walls, state.impulse.record_to(times));
}

float times_taken(const SolverParameters& k, int iteration) {
  float out = 0;
  float share = 1;
  for (int i = iteration; i < k.iterations; ++i, share *= k.momentum) out += share;
  return out;
}

Stage held_at_walls_stage() { return stage_of<record_held_back>(account("held at walls", Phase::Substep)); }

Stage missing_density_stage() {
  return stage_of<record_missing_density>(account("walls' density", Phase::Iteration));
}

Stage wall_cells_stage() {
  Stage stage = account("walls' cells", Phase::Substep);
  stage.called_for = [](const Demand& demand) -> std::string {
    return demand.parameters.coarse_cycles > 0 ? if_wall_impulse(demand) : "";
  };
  return stage_of<record_wall_cells>(stage);
}

}  // namespace sim::SIM_BACKEND
