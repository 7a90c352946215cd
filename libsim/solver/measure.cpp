#include "libsim/solver/fluid_simulation.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct MeasureJumps {
  const Vec4* position;
  const std::uint8_t* level;
  Neighbours neighbours;
  float* jumps;
  SIM_FN void operator()(int i) const {
    const Vec4 self = position[i];
    int far = 0;
    for (int k = 0; k < neighbours.size(i); ++k) {
      const int j = neighbours(i, k);
      const int step = level[i] - level[j];
      if (step >= -1 && step <= 1) continue;
      const Vec4 other = position[j];
      const Vec3 offset = xyz(self) - xyz(other);
      const float h = 0.5f * (self.w + other.w);
      far += dot(offset, offset) < h * h;
    }
    jumps[i] = static_cast<float>(far);
  }
};

struct MeasureOne {
  const Vec4* position;
  const Vec4* velocity;
  const float* density;
  Neighbours neighbours;
  float* excess;
  float* near;
  float* listed;
  float* speed;
  SIM_FN void operator()(int i) const {
    const Vec4 self = position[i];
    int within = 0;
    for (int k = 0; k < neighbours.size(i); ++k) {
      const Vec4 other = position[neighbours(i, k)];
      const Vec3 offset = xyz(self) - xyz(other);
      const float h = 0.5f * (self.w + other.w);
      within += dot(offset, offset) < h * h;
    }
    excess[i] = at_least(density[i] - 1, 0.0f);
    near[i] = static_cast<float>(within);
    listed[i] = static_cast<float>(neighbours.size(i));
    speed[i] = length(xyz(velocity[i]));
  }
};

using MeasuringView =
    ColumnView<ColumnSet{}, columns(Column::Position, Column::Velocity, Column::Id, Column::Level,
                                    Column::Predicted, Column::Neighbours, Column::Lambda, Column::Density)>;

/// A copy of the fluid with its own particles, lists and guards.
FluidState copy_of(const FluidState& live) {
  FluidState out;
  out.parameters = live.parameters;
  out.walls = live.walls;
  out.obstacles.bodies.from_host(live.obstacles.bodies.to_host());
  out.obstacles.meshes.from_host(live.obstacles.meshes.to_host());
  out.domain = live.domain;
  out.supports = live.supports;
  out.finest_support = live.finest_support;
  out.lightest_support = live.lightest_support;
  out.one_level = live.one_level;
  out.guards.resize(1);
  out.guards.zero();
  out.particles.allocate(MeasuringView::may_write, live.particles.size());
  auto& to = out.particles.all();
  const auto& from = live.particles.all();
  const auto copy = [](auto& column, const auto& source) {
    copy_within(column.data(), source.data(), source.size() * sizeof(*source.data()));
  };
  copy(to.position, from.position);
  copy(to.predicted, from.position);
  copy(to.velocity, from.velocity);
  copy(to.id, from.id);
  copy(to.level, from.level);
  return out;
}

}  // namespace

Measured measure(const FluidState& live) {
  Measured out;
  const int n = live.particles.size();
  if (n == 0) return out;
  FluidState state = copy_of(live);
  const MeasuringView p(state.particles);
  do {
    find_neighbours(state, p);
  } while (state.neighbours.grow());
  constrain_density(state, p);
  const auto size = static_cast<std::size_t>(n);
  Array<float> excess(size);
  Array<float> near(size);
  Array<float> listed(size);
  Array<float> speed(size);
  for_each("measure", n,
           MeasureOne{.position = p.position(),
                      .velocity = p.velocity(),
                      .density = p.density(),
                      .neighbours = state.neighbours.view(),
                      .excess = excess.data(),
                      .near = near.data(),
                      .listed = listed.data(),
                      .speed = speed.data()});
  out.density_error_mean = fixed_order_sum(excess, n) / n;
  const double pairs = fixed_order_sum(near, n);
  out.neighbours_mean = pairs / n;
  out.listed_mean = fixed_order_sum(listed, n) / n;
  if (!state.one_level && pairs > 0) {
    for_each("measure jumps", n, MeasureJumps{p.position(), p.level(), state.neighbours.view(), near.data()});
    out.jump_share = fixed_order_sum(near, n) / pairs;
  }
  out.density_max = static_cast<double>(maximum(state.particles.all().density, n));
  out.speed_max_m_s = static_cast<double>(maximum(speed, n));
  return out;
}

}  // namespace sim::SIM_BACKEND
