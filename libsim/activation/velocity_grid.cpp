#include "libsim/activation/velocity_grid.hpp"

#include <algorithm>

namespace sim::SIM_BACKEND {

namespace {

/// Number of consecutive particles that a team sums. Adjacent particles often share a cell, so that a team
/// writes few sums to memory.
constexpr int run_length = 16;
SIM_FN int runs_of(int n) { return (n + run_length - 1) / run_length; }

/// Largest velocity component in the sums, m/s; larger components are clamped, so that sums stay below 2^63.
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

/// A lane's running sum for the entry `place` of `sums`; place is -1 before the first value.
template <class Sum>
struct PlaceSum {
  Sum* sums;
  int place = -1;
  Sum sum{};

  /// Selects entry `here` for the next values; first adds the sum to the previous entry.
  SIM_FN void move_to(int here) {
    if (here == place) return;
    if (place >= 0) add_at_once(sums[place], sum);
    place = here;
    sum = {};
  }
  /// Adds all lanes' remaining sums to memory, with one atomic addition per entry.
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

/// Adds one run of run_length particles to one of the sums. Indices count the runs of the first sum, then
/// those of the second sum, and so on.
struct AddCellMomentum {
  struct To {
    MomentumOf of;
    MomentumSum* sums;
  };
  const Vec4* position;
  const Vec4* velocity;
  const std::uint8_t* level;
  const std::uint8_t* active;
  int n;
  To to[CellMomentum::most]{};

  template <class Team>
  SIM_FN void operator()(int index, Team team) const {
    const To& mine = to[index / runs_of(n)];
    const MomentumOf& of = mine.of;
    const int run = index % runs_of(n);
    const int end = (run + 1) * run_length < n ? (run + 1) * run_length : n;
    PlaceSum<MomentumSum> at{mine.sums};
    for (int i = run * run_length + team.rank(); i < end; i += Team::size) {
      if (of.whose != Whose::All && active[i] != static_cast<std::uint8_t>(of.whose)) continue;
      const Vec3 v = xyz(velocity[i]);
      const Vec3 x = xyz(position[i]);
      if (!all_finite(v) || !all_finite(x)) continue;
      const int cell = of.cell_of ? of.cell_of[i] : of.grid.cell_of(x);
      at.move_to(level[i] * of.grid.cells() + cell);
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

/// Converts the sums to energies, and resets the sums to zero.
struct FinishEnergy {
  std::uint64_t* sums;
  float* energy;
  SIM_FN void operator()(int i) const {
    energy[i] = static_cast<float>(static_cast<double>(sums[i]) / 65536.0);
    sums[i] = 0;
  }
};

}  // namespace

void CellMomentum::measure(MovingView particles, const std::uint8_t* active, const MomentumOf* sums, int n) {
  AddCellMomentum add{.position = particles.position(),
                      .velocity = particles.velocity(),
                      .level = particles.level(),
                      .active = active,
                      .n = particles.size()};
  const auto size_of = [&](int k) {
    const auto cells = static_cast<std::size_t>(sums[k].grid.cells());
    return sums[k].whose == Whose::Unused ? 0 : grid_levels * cells;
  };
  for (auto& sum : of_) sum = nullptr;
  std::size_t size = 0;
  for (int k = 0; k < n; ++k) size += size_of(k);
  sums_.resize(size);
  sums_.zero();
  int wanted = 0;
  MomentumSum* next = sums_.data();
  for (int k = 0; k < n; ++k) {
    if (sums[k].whose == Whose::Unused) continue;
    of_[k] = next;
    add.to[wanted++] = {sums[k], next};
    next += size_of(k);
  }
  for_each_team("add momentum", wanted * runs_of(add.n), add);
}

GridFrame cells_over(const Domain& domain, float edge) {
  const Vec3 size = domain.high - domain.low;
  const double wanted = static_cast<double>(size.x) * static_cast<double>(size.y) *
                        static_cast<double>(size.z) / std::pow(static_cast<double>(edge), 3.0);
  constexpr double most = 1 << 22;
  if (wanted > most) edge *= static_cast<float>(std::cbrt(wanted / most));
  // The 1e-4 absorbs rounding errors: a tank ten edges long gets ten cells.
  const auto count = [&](float length) {
    return std::max(1, static_cast<int>(std::ceil(length / edge - 1e-4f)));
  };
  return {{domain.low, edge}, {count(size.x), count(size.y), count(size.z)}};
}

void VelocityGrid::fit(const Domain& domain, float edge) {
  const auto [cells, block] = cells_over(domain, edge);
  const bool same = velocity_.size() && block.nx == block_.nx && block.ny == block_.ny &&
                    block.nz == block_.nz && cells.edge == frame_.edge;
  if (same) return;
  block_ = block;
  frame_ = cells;
  const auto size = static_cast<std::size_t>(block.size());
  velocity_.resize(grid_levels * size);
  energy_.resize(size);
  forget();
  make_energy_sums();
}

void VelocityGrid::forget() {
  velocity_.zero();
  energy_.zero();
}

void VelocityGrid::make_energy_sums() {
  energy_sums_.resize(energy_.size());
  energy_sums_.zero();
}

void VelocityGrid::update_energy(MovingView particles) {
  const int n = particles.size();
  for_each_team("add energy", runs_of(n),
                AddEnergy{particles.position(), particles.velocity(), particles.level(), frame(),
                          energy_sums_.data(), n});
  for_each("energy", cells(), FinishEnergy{energy_sums_.data(), energy_.data()});
}

std::size_t VelocityGrid::bytes() const { return energy_sums_.bytes() + velocity_.bytes() + energy_.bytes(); }

}  // namespace sim::SIM_BACKEND
