#include "libsim/flow/outflow.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct MarkThrough {
  const Vec4* position;
  const std::uint8_t* level;
  Walls walls;
  int* stays;
  Outflow::Amount* left;
  const float* temperature;
  HeatLedger* heat;  ///< nullptr if particles have no temperature
  SIM_FN void operator()(int i) const {
    const bool gone = walls.through(xyz(position[i]));
    stays[i] = !gone;
    if (!gone) return;
    atomic_add(&left->particles, 1);
    atomic_add(&left->mass, 1 << level[i]);
    if (heat) atomic_add(&heat->drained, HeatLedger::of(temperature[i], level[i]));
  }
};

struct ListStaying {
  const int* stays;
  const int* sums;
  int* order;
  SIM_FN void operator()(int i) const {
    if (stays[i]) order[sums[i] - 1] = i;
  }
};

struct Keep {
  const int* order;
  const float* density;
  float* out;
  SIM_FN void operator()(int i) const { out[i] = density[order[i]]; }
};

}  // namespace

Outflow::Amount Outflow::run(Particles& particles, OutflowView p, const Walls& walls, HeatLedger* heat) {
  const int n = p.size();
  left_.resize(1);
  left_.zero();
  stays_.resize(static_cast<std::size_t>(n));
  for_each("mark through", n,
           MarkThrough{.position = p.position(),
                       .level = p.level(),
                       .walls = walls,
                       .stays = stays_.data(),
                       .left = left_.data(),
                       .temperature = p.temperature(),
                       .heat = heat});
  const Amount left = left_.to_host()[0];
  if (left.particles == 0) return left;
  const int after = n - left.particles;
  scanner_.inclusive_sum(stays_, sums_);
  order_.resize(static_cast<std::size_t>(after));
  for_each("list staying", n, ListStaying{stays_.data(), sums_.data(), order_.data()});
  density_.reserve(static_cast<std::size_t>(p.capacity()));
  density_.resize(static_cast<std::size_t>(after));
  for_each("keep densities", after, Keep{order_.data(), p.density(), density_.data()});
  p.swap<Column::Density>(density_);
  particles.reorder(order_);
  return left;
}

std::size_t Outflow::bytes() const {
  return stays_.bytes() + sums_.bytes() + order_.bytes() + density_.bytes() + left_.bytes();
}

}  // namespace sim::SIM_BACKEND
