#include "libsim/levels/split_merge.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Two members of a merge that find each other through a coarser particle between them, so that the last few
/// of a level, which are too far apart for pairs, need not stay behind. One of twice their mass gives each of
/// them a half: three particles of masses 1, 2, 1 become two of mass 2, and no step is longer than a merge's.
/// A heavier one only makes them known to each other.
struct Bid {
  const Vec4* position;
  const std::uint8_t* level;
  const std::uint8_t* target;
  const std::uint8_t* waiting;
  const std::uint8_t* wish;
  const std::uint8_t* split_code;
  const std::uint8_t* gone;
  const std::uint8_t* age;
  ParticleNeighbours neighbours;
  int* first;
  int* second;
  Walls walls;
  LevelRules rules;
  LevelSupports supports;

  /// A particle that has waited without a partner and is still there.
  SIM_FN bool stranded(int i) const {
    return wish[i] && !gone[i] && age[i] > 0 && waiting[i] >= rules.looks_farther;
  }
  /// The relay names its nearest two stranded neighbours of one level that may join.
  SIM_FN void operator()(int j) const {
    first[j] = second[j] = -1;
    if (level[j] == 0 || target[j] < level[j] || split_code[j] || gone[j] || age[j] == 0) return;
    first[j] = nearest(j, -1);
    if (first[j] >= 0) second[j] = nearest(j, first[j]);
    if (second[j] < 0 || !inside_fluid(walls, position, neighbours, j, rules.inside_count))
      first[j] = second[j] = -1;
  }
  /// The nearest of the coarsest level that has any.
  SIM_FN int nearest(int j, int other) const {
    int best = -1;
    for (int k = 0; k < neighbours.size(j); ++k) {
      const int i = neighbours(j, k);
      if (i == other || level[i] >= level[j] || !stranded(i)) continue;
      if (other >= 0 && (level[i] != level[other] || !may_join(j, i, other))) continue;
      const float support = 0.5f * (position[j].w + position[i].w);
      const float distance2 = dot_to(j, i);
      if (distance2 >= support * support) continue;
      if (best >= 0 && level[i] < level[best]) continue;
      if (best >= 0 && level[i] == level[best] && distance2 >= dot_to(j, best)) continue;
      best = i;
    }
    return best;
  }
  SIM_FN bool may_join(int j, int a, int b) const {
    return level[a] + 1 < level[j] ? free_between(j, a, b) : apart(a, b, position[j].w);
  }
  /// A merged particle between them keeps from the relay and from its neighbours what a merge keeps.
  SIM_FN bool free_between(int j, int a, int b) const {
    const Vec3 centre = 0.5f * (xyz(position[a]) + xyz(position[b]));
    const float h = supports.h[level[a] + 1];
    if (!clear_of(j, centre, h)) return false;
    for (int k = 0; k < neighbours.size(j); ++k) {
      const int other = neighbours(j, k);
      if (level[other] > level[a] && !clear_of(other, centre, h)) return false;
    }
    return true;
  }
  SIM_FN bool clear_of(int other, Vec3 centre, float h) const {
    const Vec3 offset = xyz(position[other]) - centre;
    const float least = rules.stranded_overlap * (position[other].w + h) / 4;
    return dot(offset, offset) >= least * least;
  }
  SIM_FN float dot_to(int j, int i) const {
    const Vec3 offset = xyz(position[j]) - xyz(position[i]);
    return dot(offset, offset);
  }
  /// The two new particles lie half the distance of the stranded ones from each other.
  SIM_FN bool apart(int a, int b, float h) const {
    const Vec3 offset = xyz(position[a]) - xyz(position[b]);
    const float least = 2 * rules.merge_overlap * 2 * h / 4;
    return dot(offset, offset) >= least * least;
  }
};

/// A stranded particle takes the bid that comes first by chance, drawn anew each frame.
struct AcceptBid {
  const int* id;
  const int* first;
  const int* second;
  ParticleNeighbours neighbours;
  int* accepted;
  std::uint32_t frame;
  SIM_FN void operator()(int i) const {
    accepted[i] = -1;
    std::uint64_t best = ~std::uint64_t{0};
    for (int k = 0; k < neighbours.size(i); ++k) {
      const int j = neighbours(i, k);
      if (first[j] != i && second[j] != i) continue;
      const std::uint64_t chance =
          static_cast<std::uint64_t>(random_bits(static_cast<std::uint32_t>(id[j]), frame, 0x3e1u)) << 32 |
          static_cast<std::uint32_t>(id[j]);
      if (chance >= best) continue;
      best = chance;
      accepted[i] = j;
    }
  }
};

struct JoinHalves {
  Vec4* position;
  Vec4* velocity;
  std::uint8_t* level;
  std::uint8_t* history;
  std::uint8_t* age;
  std::uint8_t* waiting;
  const int* id;
  const int* first;
  const int* second;
  const int* accepted;
  std::uint8_t* gone;
  LevelCounts* counts;
  LevelSupports supports;
  float rest_density;

  SIM_FN void operator()(int j) const {
    const int a = first[j];
    const int b = second[j];
    if (a < 0 || accepted[a] != j || accepted[b] != j) return;
    // A relay that has accepted a bid itself may be changed by it at this moment.
    if (accepted[j] >= 0) return;
    const int kept = id[a] < id[b] ? a : b;
    const int left = kept == a ? b : a;
    if (level[a] + 1 < level[j]) {
      carry(kept, left);
      return;
    }
    const float lost = loss(j, kept) + loss(j, left);
    const Vec3 x_kept = 0.5f * (xyz(position[j]) + xyz(position[kept]));
    const Vec3 v_kept = 0.5f * (xyz(velocity[j]) + xyz(velocity[kept]));
    const Vec3 x = 0.5f * (xyz(position[j]) + xyz(position[left]));
    const Vec3 v = 0.5f * (xyz(velocity[j]) + xyz(velocity[left]));
    become(kept, x_kept, v_kept, position[j].w, level[j]);
    become(j, x, v, position[j].w, level[j]);
    gone[left] = 1;
    atomic_add(&counts->merges, std::uint64_t{1});
    atomic_add(&counts->energy_lost_uj, static_cast<std::uint64_t>(1e6f * fminf(lost, 1e9f)));
  }
  /// The two meet in the middle; the relay only made them known to each other.
  SIM_FN void carry(int kept, int left) const {
    const float lost = loss(left, kept);
    const int now = level[kept] + 1;
    become(kept, 0.5f * (xyz(position[kept]) + xyz(position[left])),
           0.5f * (xyz(velocity[kept]) + xyz(velocity[left])), supports.h[now], now);
    gone[left] = 1;
    atomic_add(&counts->merges, std::uint64_t{1});
    atomic_add(&counts->energy_lost_uj, static_cast<std::uint64_t>(1e6f * fminf(lost, 1e9f)));
  }
  SIM_FN float loss(int j, int i) const {
    const Vec3 difference = xyz(velocity[j]) - xyz(velocity[i]);
    return 0.25f * mass_of(position[i].w, rest_density) * dot(difference, difference);
  }
  SIM_FN void become(int i, Vec3 x, Vec3 v, float h, int now) const {
    position[i] = with_w(x, h);
    velocity[i] = with_w(v, 0);
    level[i] = static_cast<std::uint8_t>(now);
    history[i] = steady_history(now);
    age[i] = 0;
    waiting[i] = 0;
  }
};

}  // namespace

void relay_stranded(FluidState& state) {
  auto& p = state.particles;
  auto& l = state.levels;
  const int n = p.size();
  int* first = l.births.data();
  int* second = l.places.data();
  int* accepted = l.partner.data();
  for_each("bid for stranded", n,
           Bid{p.position.data(), p.level.data(), p.target.data(), p.waiting.data(), l.wish.data(),
               l.split_code.data(), l.gone.data(), p.age.data(), state.particle_neighbours(), first, second,
               state.walls, l.rules, state.supports});
  for_each("accept bids", n,
           AcceptBid{p.id.data(), first, second, state.particle_neighbours(), accepted, l.frame});
  for_each("join halves", n,
           JoinHalves{p.position.data(), p.velocity.data(), p.level.data(), p.history.data(), p.age.data(),
                      p.waiting.data(), p.id.data(), first, second, accepted, l.gone.data(), l.counts.data(),
                      state.supports, state.parameters.rest_density});
}

}  // namespace sim::SIM_BACKEND
