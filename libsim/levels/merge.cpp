#include <algorithm>

#include "libsim/levels/joining.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Updates ages, histories and waiting times. Sets `wish` for the particles that want to merge: their target
/// was coarser than their level in each of the last four frames, they do not split, and the last frame solved
/// them. A target counts for all frames since the previous turn (update of the levels).
struct Remember {
  const std::uint8_t* level;
  const std::uint8_t* target;
  const std::uint8_t* split_code;
  const std::uint8_t* active;  ///< 0 = not solved in the last frame; nullptr if all were solved
  std::uint8_t* history;
  std::uint8_t* age;
  std::uint8_t* waiting;
  std::uint8_t* wish;
  std::uint8_t* gone;
  int frames;  ///< frames since the previous update of the levels
  SIM_FN void operator()(int i) const {
    for (int k = 0; k < frames && k < 4; ++k)
      history[i] = static_cast<std::uint8_t>(history[i] << 2 | target[i]);
    age[i] = static_cast<std::uint8_t>(age[i] < 255 ? age[i] + 1 : 255);
    gone[i] = 0;
    const bool paused = active && !active[i];
    wish[i] = !split_code[i] && !paused && least_of_history(history[i]) > level[i];
    if (paused) return;
    waiting[i] = static_cast<std::uint8_t>(!wish[i]                    ? 0
                                           : waiting[i] + frames < 255 ? waiting[i] + frames
                                                                       : 255);
  }
};

/// Withdraws a particle's wish to merge if a neighbour, by its present level or its target, would be two or
/// more levels finer than the merged particle. The level of a neighbour that has waited for `lags` frames
/// does not count.
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
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const bool held = wish[i] && level[i] > 0 && team.any(finer_beside(i, team));
    if (team.rank() > 0) return;
    out[i] = held ? 0 : wish[i];
    if (held) atomic_add(&counts->merge_step, std::uint64_t{1});
  }
  /// Checks this lane's share of the neighbours of particle i.
  template <class Team>
  SIM_FN bool finer_beside(int i, Team team) const {
    const Vec4 self = position[i];
    const int size = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    for (int k = team.rank(); k < size; k += Team::size) {
      const int j = run[k];
      const bool finer = level[j] < level[i] && waiting[j] < lags;
      if (!finer && target[j] >= level[i]) continue;
      const Vec4 other = position[j];
      const Vec3 offset = xyz(self) - xyz(other);
      // Mean support of the pair once particle i is one level coarser.
      const float h = 0.5f * (supports.h[level[i] + 1] + other.w);
      if (dot(offset, offset) < h * h) return true;
    }
    return false;
  }
};

/// Priority of a pair for merging: pairs at smaller distances come first, pairs at equal distances in random
/// order. Both particles of a pair compute the same key.
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
SIM_FN Vec3 midpoint(Vec4 a, Vec4 b) { return 0.5f * (xyz(a) + xyz(b)); }

/// A neighbour as a possible merge partner. Candidates are ordered by the pair's key, then by their index in
/// the neighbour list.
struct Candidate {
  PairKey key;
  int place;  ///< index in the neighbour list; -1: none
  SIM_FN bool before(const Candidate& other) const {
    return key.before(other.key) ||
           (key.distance2 == other.key.distance2 && key.chance == other.key.chance && place < other.place);
  }
};

/// Each particle that wants to merge proposes the nearest partner of its level with which it may merge.
template <class Boundary>
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
  Boundary walls;
  LevelRules rules;
  LevelSupports supports;

  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const int found = wish[i] ? nearest(i, team) : -1;
    if (team.rank() == 0) partner[i] = found;
  }

  /// Returns the partner that particle i proposes; -1: none. Tries candidates one by one, the nearest first.
  template <class Team>
  SIM_FN int nearest(int i, Team team) const {
    const float reach = 2 * rules.merge_reach * supports.h[level[i] + 1] / 4;
    bool overlapped = false;
    bool looks_farther = false;
    for (Candidate tried{{-1, 0}, -1};;) {
      tried = first_after(tried, i, reach * reach, team);
      if (tried.place < 0) break;
      const int j = neighbours(i, tried.place);
      const bool far = tried.key.distance2 > reach * reach;
      if (far && !looks_farther && !inside(i, team)) break;
      looks_farther = far;
      if (far && !inside(j, team)) continue;
      if (!overlaps(i, j, team)) return j;
      overlapped = true;
    }
    if (overlapped && team.rank() == 0) atomic_add(&counts->merge_overlap, std::uint64_t{1});
    return -1;
  }

  /// Returns the nearest candidate after `tried`. A candidate is within merge_reach, unless it or particle i
  /// has waited long enough to search farther (looks_farther).
  template <class Team>
  SIM_FN Candidate first_after(const Candidate& tried, int i, float reach2, Team team) const {
    const Vec4 self = position[i];
    const int size = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    Candidate best{{3.4e38f, 0}, -1};
    for (int k = team.rank(); k < size; k += Team::size) {
      const int j = run[k];
      if (!wish[j] || level[j] != level[i]) continue;
      if (rules.merge_same_target && target[j] != target[i]) continue;
      const Candidate next{pair_key(self, position[j], id[i], id[j]), k};
      if (!next.before(best) || !tried.before(next)) continue;
      const bool near = next.key.distance2 <= reach2;
      if (near || waiting[i] >= rules.looks_farther || waiting[j] >= rules.looks_farther) best = next;
    }
    return team.first(best);
  }

  template <class Team>
  SIM_FN bool inside(int i, Team team) const {
    return inside_fluid(walls, position, neighbours, i, rules.inside_count, team);
  }

  template <class Team>
  SIM_FN bool overlaps(int i, int j, Team team) const {
    const Vec3 centre = midpoint(position[i], position[j]);
    return !free_of_bodies(walls, centre) ||
           overlaps_coarser(position, level, neighbours, i, level[i], centre, supports.h[level[i] + 1],
                            rules.merge_overlap, team);
  }
};

/// Refuses a mutual proposal if its merged particle would overlap the merged particle of another mutual
/// proposal that comes first in the order of PairKey.
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
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    int kept = -1;
    if (mutual(i) && id[i] < id[partner[i]]) {
      const int j = partner[i];
      if (!team.any(early_beside(i, j, i, team)) && !team.any(early_beside(i, j, j, team))) kept = j;
    }
    if (team.rank() == 0) out[i] = kept;
  }
  /// True if the merged particle of i and j would overlap the merged particle of another pair that comes
  /// first in the order of PairKey. Checks this lane's share of the neighbours of `member`, which is i or j.
  template <class Team>
  SIM_FN bool early_beside(int i, int j, int member, Team team) const {
    const PairKey own = pair_key(position[i], position[j], id[i], id[j]);
    const Vec3 centre = midpoint(position[i], position[j]);
    const int size = neighbours.size(member);
    const NeighbourRun run = neighbours.run(member);
    for (int k = team.rank(); k < size; k += Team::size) {
      const int a = run[k];
      if (a == i || a == j || !mutual(a)) continue;
      const int b = partner[a];
      const Vec4 merged = with_w(midpoint(position[a], position[b]), supports.h[level[a] + 1]);
      if (clear_of(merged, centre, supports.h[level[i] + 1], rules.merge_overlap)) continue;
      if (pair_key(position[a], position[b], id[a], id[b]).before(own)) return true;
    }
    return false;
  }
};

struct Merge {
  Joining joining;
  const int* partner;

  SIM_FN void operator()(int i) const {
    if (partner[i] >= 0) joining.join(i, partner[i]);
  }
};

template <class Boundary>
void propose(LevelState& l, const LevelFluid& fluid, Boundary boundary) {
  const LevelView& p = fluid.particles;
  for_each_team("propose merges", p.size(),
                Propose<Boundary>{.position = p.position(),
                                  .level = p.level(),
                                  .target = p.target(),
                                  .waiting = p.waiting(),
                                  .wish = l.wish.data(),
                                  .id = p.id(),
                                  .neighbours = fluid.neighbours,
                                  .partner = l.partner.data(),
                                  .counts = l.counts.data(),
                                  .walls = boundary,
                                  .rules = l.rules,
                                  .supports = fluid.supports});
}

}  // namespace

void merge_pairs(LevelState& l, const LevelFluid& fluid, const Descents& descents) {
  const LevelView& p = fluid.particles;
  const int n = p.size();
  for_each("remember levels", n,
           Remember{.level = p.level(),
                    .target = p.target(),
                    .split_code = l.split_code.data(),
                    .active = fluid.merges_pause ? fluid.last_active : nullptr,
                    .history = p.history(),
                    .age = p.age(),
                    .waiting = p.waiting(),
                    .wish = l.wish.data(),
                    .gone = l.gone.data(),
                    .frames = std::max(1, l.turns.frames_since)});
  if (l.rules.merge_keeps_steps) {
    for_each_team("keep steps", n,
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
  fluid.solids.count > 0 ? propose(l, fluid, fluid.solids) : propose(l, fluid, fluid.solids.walls);
  for_each_team("keep merges apart", n,
                KeepApart{.position = p.position(),
                          .level = p.level(),
                          .id = p.id(),
                          .partner = l.partner.data(),
                          .neighbours = fluid.neighbours,
                          .out = l.places.data(),
                          .rules = l.rules,
                          .supports = fluid.supports});
  for_each("merge", n, Merge{joining(l, fluid, descents), l.places.data()});
}

}  // namespace sim::SIM_BACKEND
