#include "libsim/levels/joining.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Steps ages and histories, and finds who wants to be coarser and has wanted it for four frames.
struct Remember {
  const std::uint8_t* level;
  const std::uint8_t* target;
  const std::uint8_t* split_code;
  const std::uint8_t* active;  ///< nullptr when everyone was solved
  std::uint8_t* history;
  std::uint8_t* age;
  std::uint8_t* waiting;
  std::uint8_t* wish;
  std::uint8_t* gone;
  SIM_FN void operator()(int i) const {
    history[i] = static_cast<std::uint8_t>(history[i] << 2 | target[i]);
    age[i] = static_cast<std::uint8_t>(age[i] < 255 ? age[i] + 1 : 255);
    gone[i] = 0;
    const bool paused = active && !active[i];
    wish[i] = !split_code[i] && !paused && least_of_history(history[i]) > level[i];
    if (paused) return;
    waiting[i] = static_cast<std::uint8_t>(!wish[i] ? 0 : waiting[i] < 255 ? waiting[i] + 1 : 255);
  }
};

/// Drops the wish where a merge would leave a neighbour two levels finer, now or soon.
struct KeepSteps {
  const Vec4* position;
  const std::uint8_t* level;
  const std::uint8_t* target;
  const std::uint8_t* waiting;
  const std::uint8_t* wish;
  ParticleNeighbours neighbours;
  std::uint8_t* out;
  LevelCounts* counts;
  int lags;
  LevelSupports supports;
  SIM_FN void operator()(int i) const {
    out[i] = wish[i];
    if (!wish[i] || level[i] == 0) return;
    const Vec4 self = position[i];
    for (int k = 0; k < neighbours.size(i); ++k) {
      const int j = neighbours(i, k);
      const bool finer = level[j] < level[i] && waiting[j] < lags;
      if (!finer && target[j] >= level[i]) continue;
      const Vec4 other = position[j];
      const Vec3 offset = xyz(self) - xyz(other);
      // As wide as it will see once it is coarser.
      const float h = 0.5f * (supports.h[level[i] + 1] + other.w);
      if (dot(offset, offset) >= h * h) continue;
      out[i] = 0;
      atomic_add(&counts->merge_step, std::uint64_t{1});
      return;
    }
  }
};

/// A pair in the order in which pairs are preferred: the nearer, then by chance; the same from both sides.
struct PairKey {
  float distance2;
  std::uint32_t chance;
  SIM_FN bool before(const PairKey& other) const {
    return distance2 < other.distance2 || (distance2 == other.distance2 && chance < other.chance);
  }
};
SIM_FN PairKey pair_key(Vec4 a, Vec4 b, int id_a, int id_b) {
  const Vec3 offset = xyz(a) - xyz(b);
  const auto low = static_cast<std::uint32_t>(id_a < id_b ? id_a : id_b);
  const auto high = static_cast<std::uint32_t>(id_a < id_b ? id_b : id_a);
  return {dot(offset, offset), random_bits(low, high, 0)};
}
SIM_FN Vec3 middle(Vec4 a, Vec4 b) { return 0.5f * (xyz(a) + xyz(b)); }

/// Each wishing particle names the nearest partner of its level with which it may merge.
struct Propose {
  const Vec4* position;
  const std::uint8_t* level;
  const std::uint8_t* target;
  const std::uint8_t* waiting;
  const std::uint8_t* wish;
  const int* id;
  ParticleNeighbours neighbours;
  int* partner;
  LevelCounts* counts;
  Walls walls;
  LevelRules rules;
  LevelSupports supports;

  SIM_FN void operator()(int i) const {
    partner[i] = -1;
    if (!wish[i]) return;
    const Vec4 self = position[i];
    PairKey best{3.4e38f, 0};
    bool overlapped = false;
    for (int k = 0; k < neighbours.size(i); ++k) {
      const int j = neighbours(i, k);
      if (!wish[j] || level[j] != level[i]) continue;
      if (rules.merge_same_target && target[j] != target[i]) continue;
      const PairKey key = pair_key(self, position[j], id[i], id[j]);
      if (!key.before(best) || !in_reach(i, j, key.distance2)) continue;
      if (overlaps(i, j)) {
        overlapped = true;
        continue;
      }
      best = key;
      partner[i] = j;
    }
    if (overlapped && partner[i] < 0) atomic_add(&counts->merge_overlap, std::uint64_t{1});
  }

  /// Members lie at most merge_reach radii of the new particle from its centre.
  SIM_FN bool in_reach(int i, int j, float distance2) const {
    const float reach = 2 * rules.merge_reach * supports.h[level[i] + 1] / 4;
    if (distance2 <= reach * reach) return true;
    return (waiting[i] >= rules.looks_farther || waiting[j] >= rules.looks_farther) && inside(i) && inside(j);
  }

  SIM_FN bool inside(int i) const { return inside_fluid(walls, position, neighbours, i, rules.inside_count); }

  SIM_FN bool overlaps(int i, int j) const {
    return overlaps_coarser(position, level, neighbours, i, level[i], middle(position[i], position[j]),
                            supports.h[level[i] + 1], rules.merge_overlap);
  }
};

/// Of mutual proposals whose new particles would overlap each other, the first is kept.
struct KeepApart {
  const Vec4* position;
  const std::uint8_t* level;
  const int* id;
  const int* partner;
  ParticleNeighbours neighbours;
  int* out;
  LevelRules rules;
  LevelSupports supports;

  SIM_FN bool mutual(int i) const { return partner[i] >= 0 && partner[partner[i]] == i; }
  SIM_FN void operator()(int i) const {
    out[i] = -1;
    if (!mutual(i) || id[i] > id[partner[i]]) return;
    const int j = partner[i];
    if (free_beside(i, j, i) && free_beside(i, j, j)) out[i] = j;
  }
  SIM_FN bool free_beside(int i, int j, int member) const {
    const PairKey own = pair_key(position[i], position[j], id[i], id[j]);
    const Vec3 centre = middle(position[i], position[j]);
    for (int k = 0; k < neighbours.size(member); ++k) {
      const int a = neighbours(member, k);
      if (a == i || a == j || !mutual(a)) continue;
      const int b = partner[a];
      const Vec4 merged = with_w(middle(position[a], position[b]), supports.h[level[a] + 1]);
      if (clear_of(merged, centre, supports.h[level[i] + 1], rules.merge_overlap)) continue;
      if (pair_key(position[a], position[b], id[a], id[b]).before(own)) return false;
    }
    return true;
  }
};

struct Merge {
  Joining joining;
  const int* partner;

  SIM_FN void operator()(int i) const {
    if (partner[i] >= 0) joining.join(i, partner[i]);
  }
};

}  // namespace

void merge_pairs(LevelState& l, const LevelFluid& fluid) {
  const LevelView& p = fluid.particles;
  const int n = p.size();
  for_each("remember levels", n,
           Remember{.level = p.level(),
                    .target = p.target(),
                    .split_code = l.split_code.data(),
                    .active = fluid.last_active,
                    .history = p.history(),
                    .age = p.age(),
                    .waiting = p.waiting(),
                    .wish = l.wish.data(),
                    .gone = l.gone.data()});
  if (l.rules.merge_keeps_steps) {
    for_each("keep steps", n,
             KeepSteps{.position = p.position(),
                       .level = p.level(),
                       .target = p.target(),
                       .waiting = p.waiting(),
                       .wish = l.wish.data(),
                       .neighbours = fluid.neighbours,
                       .out = l.status.data(),
                       .counts = l.counts.data(),
                       .lags = l.rules.lags,
                       .supports = fluid.supports});
    l.wish.swap(l.status);
  }
  for_each("propose merges", n,
           Propose{.position = p.position(),
                   .level = p.level(),
                   .target = p.target(),
                   .waiting = p.waiting(),
                   .wish = l.wish.data(),
                   .id = p.id(),
                   .neighbours = fluid.neighbours,
                   .partner = l.partner.data(),
                   .counts = l.counts.data(),
                   .walls = fluid.walls,
                   .rules = l.rules,
                   .supports = fluid.supports});
  for_each("keep merges apart", n,
           KeepApart{.position = p.position(),
                     .level = p.level(),
                     .id = p.id(),
                     .partner = l.partner.data(),
                     .neighbours = fluid.neighbours,
                     .out = l.places.data(),
                     .rules = l.rules,
                     .supports = fluid.supports});
  for_each("merge", n, Merge{joining(l, fluid), l.places.data()});
}

}  // namespace sim::SIM_BACKEND
