#include "libsim/flow/flow.hpp"

#include <algorithm>
#include <cstring>

namespace sim::SIM_BACKEND {

namespace {

struct MarkCorners {
  const Vec4* position;
  Corners corners;
  int* inside;
  SIM_FN void operator()(int i) const { inside[i] = corners.hold(xyz(position[i])); }
};

struct ListCorners {
  const Vec4* position;
  const int* id;
  const int* inside;
  const int* rank;
  std::uint64_t* keys;
  int* order;
  Vec3 up;

  SIM_FN void operator()(int i) const {
    if (!inside[i]) return;
    const int place = rank[i] - 1;
    keys[place] = std::uint64_t{ordered(dot(up, xyz(position[i])))} << 32 | static_cast<std::uint32_t>(id[i]);
    order[place] = i;
  }
  /// Converts a float to an unsigned integer; larger floats give larger integers.
  SIM_FN static std::uint32_t ordered(float height) {
    std::uint32_t bits = 0;
    memcpy(&bits, &height, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
  }
};

}  // namespace

int CornerColumns::find(Reads<Column::Position, Column::Id> particles, const Corners& corners, Vec3 up) {
  const int n = particles.size();
  if (n == 0) return 0;
  inside_.resize(static_cast<std::size_t>(n));
  for_each("mark corners", n, MarkCorners{particles.position(), corners, inside_.data()});
  scanner_.inclusive_sum(inside_, rank_);
  const int found = last_of(rank_);
  keys_.resize(static_cast<std::size_t>(found));
  order_.resize(static_cast<std::size_t>(found));
  for_each("list corners", n,
           ListCorners{particles.position(), particles.id(), inside_.data(), rank_.data(), keys_.data(),
                       order_.data(), up});
  sorter_.sort(keys_, order_);
  return found;
}

std::size_t CornerColumns::bytes() const {
  return inside_.bytes() + rank_.bytes() + order_.bytes() + keys_.bytes();
}

namespace {

struct SumMass {
  const int* taken;
  const std::uint8_t* level;
  int* mass;
  SIM_FN void operator()(int k) const { mass[k] = 1 << level[taken[k]]; }
};

/// Finds the smallest number of particles, taken from the front of the list lowest_first (Exchange::run),
/// whose mass in m_* is at least `need` > 0. At most one index k writes the result.
struct FindCut {
  const int* mass;
  const int* sum;
  Exchange::Cut* cut;
  std::int64_t need;
  SIM_FN void operator()(int k) const {
    if (sum[k] >= need && sum[k] - mass[k] < need) *cut = {k + 1, sum[k]};
  }
};

struct SetAll {
  int* values;
  int value;
  SIM_FN void operator()(int i) const { values[i] = value; }
};

/// Marks the particles that a nozzle takes from the corners as removed, and gives their ids to the first of
/// the `made` particles that the nozzle adds.
struct Leave {
  const int* taken;
  const int* id;
  int* kept;
  int* ids;
  int made;
  const std::uint8_t* level;
  const float* temperature;
  HeatLedger* heat;  ///< nullptr if particles have no temperature
  SIM_FN void operator()(int k) const {
    const int i = taken[k];
    kept[i] = 0;
    if (k < made) ids[k] = id[i];
    if (heat) atomic_add(&heat->taken, HeatLedger::of(temperature[i], level[i]));
  }
};

struct Stay {
  const int* kept;
  const int* kept_sum;
  int* order;
  SIM_FN void operator()(int i) const {
    if (kept[i]) order[kept_sum[i] - 1] = i;
  }
};

/// Assigns the lowest free ids to the particles that a nozzle adds and that get no id of a particle that it
/// took.
struct TakeFree {
  const int* free_ids;
  int* ids;
  SIM_FN void operator()(int k) const { ids[k] = free_ids[k]; }
};

/// Initialises the particles that a nozzle adds, except position, velocity and temperature. Their target
/// level is their level, which also fills the four entries of their history of targets. Saliency is not
/// measured yet and is set to 0.
struct Make {
  const int* ids;
  Vec4* position;
  int* id;
  std::uint8_t* level;
  std::uint8_t* target;
  std::uint8_t* history;
  float* saliency;
  float* unrest;
  Vec4* drift;
  Descents descents;
  int first;
  float support;
  std::uint8_t new_level;
  SIM_FN void operator()(int k) const {
    const int i = first + k;
    position[i].w = support;
    id[i] = ids[k];
    level[i] = new_level;
    if (target) target[i] = new_level;
    if (history) history[i] = static_cast<std::uint8_t>(0x55 * new_level);  // four entries of two bits
    if (saliency) saliency[i] = 0;
    if (unrest) unrest[i] = 0;
    if (drift) drift[i] = {0, 0, 0, 0};
    descents.make(i);
  }
};

}  // namespace

std::size_t Exchange::bytes() const {
  std::size_t sum = cut_.bytes();
  for (const auto* column :
       {&mass_, &mass_sum_, &kept_, &kept_sum_, &order_, &id_, &free_, &free_sum_, &free_ids_})
    sum += column->bytes();
  return sum;
}

Exchange::Cut Exchange::cut_at(std::int64_t need) {
  if (need <= 0) return {0, 0};
  cut_.resize(1);
  for_each("cut", static_cast<int>(mass_.size()), FindCut{mass_.data(), mass_sum_.data(), cut_.data(), need});
  return cut_.to_host()[0];
}

int Exchange::run(Particles& particles, const LevelSupports& supports, const int* lowest_first, int found,
                  int sites, int layers, int level, std::int64_t& reservoir, HeatLedger* heat) {
  const ExchangeView p(particles);
  const int n = p.size();
  mass_.resize(static_cast<std::size_t>(found));
  for_each("weigh", found, SumMass{lowest_first, p.level(), mass_.data()});
  scanner_.inclusive_sum(mass_, mass_sum_);
  const std::int64_t layer_mass = static_cast<std::int64_t>(sites) << level;
  layers = static_cast<int>(std::min<std::int64_t>(layers, (reservoir + last_of(mass_sum_)) / layer_mass));
  Cut cut{};
  int made = 0;
  for (; layers > 0; --layers) {
    cut = cut_at(layers * layer_mass - reservoir);
    made = layers * sites;
    if (n > 0 && n - cut.taken + made <= p.capacity()) break;
  }
  if (layers <= 0) return 0;

  // The new order: the remaining particles, then one entry per new particle. These entries are copies of
  // particle 0; Make and the caller overwrite their columns.
  kept_.resize(static_cast<std::size_t>(n));
  id_.resize(static_cast<std::size_t>(made));
  for_each("keep", n, SetAll{kept_.data(), 1});
  for_each("leave", cut.taken,
           Leave{.taken = lowest_first,
                 .id = p.id(),
                 .kept = kept_.data(),
                 .ids = id_.data(),
                 .made = made,
                 .level = p.level(),
                 .temperature = p.temperature(),
                 .heat = heat});
  if (made > cut.taken) {
    // The ids of the taken particles are not among the free ids, because new particles have got them already.
    list_free_ids(p, nullptr, scanner_, free_, free_sum_, free_ids_);
    for_each("take ids", made - cut.taken, TakeFree{free_ids_.data(), id_.data() + cut.taken});
  }
  scanner_.inclusive_sum(kept_, kept_sum_);
  const int staying = n - cut.taken;
  order_.resize(static_cast<std::size_t>(staying + made));
  for_each("room", made, SetAll{order_.data() + staying, 0});
  for_each("stay", n, Stay{kept_.data(), kept_sum_.data(), order_.data()});
  particles.reorder(order_);
  for_each("make", made,
           Make{.ids = id_.data(),
                .position = p.position(),
                .id = p.id(),
                .level = p.level(),
                .target = p.target(),
                .history = p.history(),
                .saliency = p.saliency(),
                .unrest = p.unrest(),
                .drift = p.drift(),
                .descents = particles.descents(),
                .first = staying,
                .support = supports.h[level],
                .new_level = static_cast<std::uint8_t>(level)});
  reservoir += cut.mass - layers * layer_mass;
  return layers;
}

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
