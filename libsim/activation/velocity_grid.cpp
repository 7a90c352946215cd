#include "libsim/activation/velocity_grid.hpp"

#include <algorithm>

namespace sim::SIM_BACKEND {

namespace {

/// Particles that a team adds up before it goes to memory: neighbours in memory share a cell.
constexpr int run_length = 16;
int runs_of(int n) { return (n + run_length - 1) / run_length; }

/// Beyond this speed, m/s, a particle counts with this speed: sums of 2^63 stay out of reach.
constexpr float fastest = 1000;

SIM_FN std::uint64_t fixed(float value) {
  return static_cast<std::uint64_t>(
      static_cast<std::int64_t>(at_most(at_least(value, -fastest), fastest) * 1048576.0f));
}

template <class Team>
SIM_FN std::uint64_t total(Team team, std::uint64_t part) {
  return team.sum(part);
}
template <class Team>
SIM_FN MomentumSum total(Team team, const MomentumSum& part) {
  return {team.sum(part.mass), team.sum(part.x), team.sum(part.y), team.sum(part.z)};
}

SIM_FN void add_at_once(std::uint64_t& to, std::uint64_t sum) { atomic_add(&to, sum); }
SIM_FN void add_at_once(MomentumSum& to, const MomentumSum& sum) {
  atomic_add(&to.mass, sum.mass);
  atomic_add(&to.x, sum.x);
  atomic_add(&to.y, sum.y);
  atomic_add(&to.z, sum.z);
}

/// What a lane has summed up for one place; -1 while there is none.
template <class Sum>
struct PlaceSum {
  Sum* sums;
  int place = -1;
  Sum sum{};

  /// What follows is for `here`.
  SIM_FN void move_to(int here) {
    if (here == place) return;
    if (place >= 0) add_at_once(sums[place], sum);
    place = here;
    sum = {};
  }
  /// Ends the run; the lanes' sums for one place go to memory together.
  template <class Team>
  SIM_FN void finish(Team team) {
    constexpr int none = 2147483647;
    while (true) {
      const int next = team.min(place < 0 ? none : place);
      if (next == none) return;
      const bool mine = place == next;
      const Sum all = total(team, mine ? sum : Sum{});
      if (team.rank() == 0) add_at_once(sums[next], all);
      if (mine) place = -1;
    }
  }
};

struct AddMomentum {
  const Vec4* position;
  const Vec4* velocity;
  const std::uint8_t* level;
  const std::uint8_t* active;
  const int* cell_of;
  GridFrame grid;
  MomentumSum* sums;
  int n;
  std::uint8_t which;

  template <class Team>
  SIM_FN void operator()(int run, Team team) const {
    const int end = (run + 1) * run_length < n ? (run + 1) * run_length : n;
    PlaceSum<MomentumSum> at{sums};
    for (int i = run * run_length + team.rank(); i < end; i += Team::size) {
      if (active && active[i] != which) continue;
      const Vec3 v = xyz(velocity[i]);
      const Vec3 x = xyz(position[i]);
      if (!all_finite(v) || !all_finite(x)) continue;
      const int cell = cell_of ? cell_of[i] : grid.cell_of(x);
      at.move_to(level[i] * grid.cells() + cell);
      const std::uint64_t mass = std::uint64_t{1} << level[i];
      at.sum.mass += mass;
      at.sum.x += mass * fixed(v.x);
      at.sum.y += mass * fixed(v.y);
      at.sum.z += mass * fixed(v.z);
    }
    at.finish(team);
  }
};

struct AddEnergy {
  const Vec4* position;
  const Vec4* velocity;
  const std::uint8_t* level;
  GridFrame grid;
  std::uint64_t* sums;
  int n;

  template <class Team>
  SIM_FN void operator()(int run, Team team) const {
    const int end = (run + 1) * run_length < n ? (run + 1) * run_length : n;
    PlaceSum<std::uint64_t> at{sums};
    for (int i = run * run_length + team.rank(); i < end; i += Team::size) {
      const Vec3 v = xyz(velocity[i]);
      const Vec3 x = xyz(position[i]);
      if (!all_finite(v) || !all_finite(x)) continue;
      at.move_to(grid.cell_of(x));
      const float specific = at_most(0.5f * dot(v, v), 0.5f * fastest * fastest);
      at.sum += (std::uint64_t{1} << level[i]) * static_cast<std::uint64_t>(specific * 65536.0f);
    }
    at.finish(team);
  }
};

/// Turns sums into means and fills what is empty.
struct FinishVelocity {
  const MomentumSum* sums;
  Vec4* velocity;
  int cells;

  SIM_FN void operator()(int i) const {
    if (sums[i].mass > 0) {
      velocity[i] = with_w(mean_velocity(sums[i]), value_measured);
      return;
    }
    if (velocity[i].w == value_measured) {
      velocity[i].w = value_borrowed;
      return;
    }
    MomentumSum all{};
    for (int level = 0; level < grid_levels; ++level) {
      const MomentumSum& other = sums[level * cells + i % cells];
      all = {all.mass + other.mass, all.x + other.x, all.y + other.y, all.z + other.z};
    }
    velocity[i] = all.mass > 0 ? with_w(mean_velocity(all), value_borrowed) : Vec4{0, 0, 0, value_unknown};
  }
};

struct FinishEnergy {
  const std::uint64_t* sums;
  float* energy;
  SIM_FN void operator()(int i) const {
    energy[i] = static_cast<float>(static_cast<double>(sums[i]) / 65536.0);
  }
};

}  // namespace

void add_momentum(MovingView particles, const std::uint8_t* active, const int* cell_of, GridFrame grid,
                  Array<MomentumSum>& sums, std::uint8_t which) {
  sums.resize(static_cast<std::size_t>(grid_levels * grid.cells()));
  sums.zero();
  const int n = particles.size();
  for_each_team("add momentum", runs_of(n),
                AddMomentum{.position = particles.position(),
                            .velocity = particles.velocity(),
                            .level = particles.level(),
                            .active = active,
                            .cell_of = cell_of,
                            .grid = grid,
                            .sums = sums.data(),
                            .n = n,
                            .which = which});
}

void VelocityGrid::fit(const Domain& domain, float edge) {
  const Vec3 size = domain.high - domain.low;
  const double wish = static_cast<double>(size.x) * static_cast<double>(size.y) *
                      static_cast<double>(size.z) / std::pow(static_cast<double>(edge), 3.0);
  constexpr double most = 1 << 22;
  if (wish > most) edge *= static_cast<float>(std::cbrt(wish / most));
  // A tank of ten edges has ten cells, whatever its size has lost to rounding.
  const auto count = [&](float length) {
    return std::max(1, static_cast<int>(std::ceil(length / edge - 1e-4f)));
  };
  const CellBlock block{count(size.x), count(size.y), count(size.z)};
  const bool same = velocity_.size() && block.nx == block_.nx && block.ny == block_.ny &&
                    block.nz == block_.nz && edge == frame_.edge;
  if (same) return;
  block_ = block;
  frame_ = {domain.low, edge};
  const auto cells = static_cast<std::size_t>(block.size());
  velocity_.resize(grid_levels * cells);
  velocity_.zero();
  energy_.resize(cells);
  energy_.zero();
  energy_sums_.resize(cells);
}

void VelocityGrid::update_velocity(MovingView particles, const std::uint8_t* active) {
  add_momentum(particles, active, nullptr, frame(), sums_);
  for_each("mean velocity", grid_levels * cells(), FinishVelocity{sums_.data(), velocity_.data(), cells()});
}

void VelocityGrid::update_energy(MovingView particles) {
  energy_sums_.zero();
  const int n = particles.size();
  for_each_team("add energy", runs_of(n),
                AddEnergy{particles.position(), particles.velocity(), particles.level(), frame(),
                          energy_sums_.data(), n});
  for_each("energy", cells(), FinishEnergy{energy_sums_.data(), energy_.data()});
}

std::size_t VelocityGrid::bytes() const {
  return sums_.bytes() + energy_sums_.bytes() + velocity_.bytes() + energy_.bytes();
}

}  // namespace sim::SIM_BACKEND
