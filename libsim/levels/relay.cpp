#include "libsim/levels/joining.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Value of a relay's bid for a stranded particle (see Stranded and Bid). A stranded particle accepts the
/// largest bid. The value is random, new in each turn (update of the levels), and never 0.
SIM_FN std::uint64_t worth_of(int relay_id, std::uint32_t frame) {
  const auto id = static_cast<std::uint32_t>(relay_id);
  return ~(static_cast<std::uint64_t>(random_bits(id, frame, 0x3e1u)) << 32 | id);
}

/// A stranded neighbour of a relay: a particle that has waited long without a merge partner. Coarser
/// neighbours come first, then nearer ones, then those with a lower index in the list.
struct Stranded {
  int level;
  float distance2;
  int place;  ///< index in the relay's neighbour list; -1: none
  SIM_FN bool before(const Stranded& other) const {
    if (level != other.level) return level > other.level;
    return distance2 < other.distance2 || (distance2 == other.distance2 && place < other.place);
  }
};

/// Two stranded particles merge through a coarser particle between them, the relay. Otherwise the last
/// particles of a level, which are too far apart to merge directly, would remain. A relay with twice a
/// stranded particle's mass gives each of the two a half of itself: particles of masses 1, 2, 1 become two of
/// mass 2. A heavier relay does not change: the two particles that it selected merge at their midpoint.
template <class Boundary>
struct Bid {
  const Vec4* position;
  const std::uint8_t* level;
  const std::uint8_t* target;
  const std::uint8_t* waiting;
  const std::uint8_t* wish;
  const std::uint8_t* split_code;
  const std::uint8_t* gone;
  const std::uint8_t* age;
  const int* id;
  ParticleNeighbours neighbours;
  int* first;
  int* second;
  std::uint64_t* taken;  ///< value (worth_of) of the best bid for each stranded particle; 0: none
  Boundary walls;
  LevelRules rules;
  LevelSupports supports;
  std::uint32_t frame;

  /// True if particle i wants to merge, has waited long without a partner, and was not merged in this frame.
  SIM_FN bool stranded(int i) const {
    return wish[i] && !gone[i] && age[i] > 0 && waiting[i] >= rules.looks_farther;
  }
  /// Particle j, as a relay, selects two of its stranded neighbours: first the one that nearest() returns,
  /// then the one of the same level that second_beside() returns.
  template <class Team>
  SIM_FN void operator()(int j, Team team) const {
    int a = -1;
    int b = -1;
    if (level[j] > 0 && target[j] >= level[j] && !split_code[j] && !gone[j] && age[j] > 0) {
      a = nearest(j, team);
      if (a >= 0) b = second_beside(j, a, team);
      if (b >= 0 && !inside_fluid(walls, position, neighbours, j, rules.inside_count, team)) b = -1;
    }
    if (team.rank() > 0) return;
    first[j] = b >= 0 ? a : -1;
    second[j] = b;
    if (b < 0) return;
    const std::uint64_t worth = worth_of(id[j], frame);
    atomic_max(&taken[a], worth);
    atomic_max(&taken[b], worth);
  }
  /// Index of the stranded neighbour nearest to relay j, among its stranded neighbours of the coarsest level;
  /// -1: none.
  template <class Team>
  SIM_FN int nearest(int j, Team team) const {
    const Stranded found = first_after({most_levels, 0, -1}, j, -1, team);
    return found.place < 0 ? -1 : neighbours(j, found.place);
  }
  /// Index of the stranded neighbour nearest to relay j that has the level of `other` and may merge with it;
  /// -1: none.
  template <class Team>
  SIM_FN int second_beside(int j, int other, Team team) const {
    for (Stranded tried{most_levels, 0, -1};;) {
      tried = first_after(tried, j, other, team);
      if (tried.place < 0) return -1;
      const int i = neighbours(j, tried.place);
      if (halves(j, other) || free_between(j, i, other, team)) return i;
    }
  }
  template <class Team>
  SIM_FN Stranded first_after(const Stranded& tried, int j, int other, Team team) const {
    const int size = neighbours.size(j);
    const NeighbourRun run = neighbours.run(j);
    Stranded best{-1, 0, -1};
    for (int k = team.rank(); k < size; k += Team::size) {
      const int i = run[k];
      if (i == other || level[i] >= level[j] || !stranded(i)) continue;
      if (other >= 0 && level[i] != level[other]) continue;
      if (other >= 0 && halves(j, other) && !apart(i, other, position[j].w)) continue;
      if (halves(j, i) && !free_of_bodies(walls, 0.5f * (xyz(position[j]) + xyz(position[i])))) continue;
      const float support = 0.5f * (position[j].w + position[i].w);
      const Vec3 offset = xyz(position[j]) - xyz(position[i]);
      const Stranded next{level[i], dot(offset, offset), k};
      if (next.distance2 < support * support && next.before(best) && tried.before(next)) best = next;
    }
    return team.first(best);
  }
  /// True if relay j has twice the mass of `member`, so that it gives each of the two members a half of
  /// itself.
  SIM_FN bool halves(int j, int member) const { return level[member] + 1 == level[j]; }
  /// True if a particle merged at the midpoint of a and b would be outside obstacles, and its distances from
  /// relay j and from the neighbours of j coarser than a and b would be at least stranded_overlap times the
  /// sum of the radii.
  template <class Team>
  SIM_FN bool free_between(int j, int a, int b, Team team) const {
    const Vec3 centre = 0.5f * (xyz(position[a]) + xyz(position[b]));
    const float h = supports.h[level[a] + 1];
    return free_of_bodies(walls, centre) && clear_of(position[j], centre, h, rules.stranded_overlap) &&
           !overlaps_coarser(position, level, neighbours, j, level[a], centre, h, rules.stranded_overlap,
                             team);
  }
  /// True if the two new particles would be at least merge_overlap times the sum of their radii apart. Their
  /// distance is half the distance of a and b. h: support of the relay, and so of each new particle.
  SIM_FN bool apart(int a, int b, float h) const {
    const Vec3 offset = xyz(position[a]) - xyz(position[b]);
    const float least = 2 * rules.merge_overlap * 2 * h / 4;
    return dot(offset, offset) >= least * least;
  }
};

struct JoinHalves {
  Joining joining;
  const int* id;
  const int* first;
  const int* second;
  const std::uint64_t* taken;
  std::uint32_t frame;

  SIM_FN void operator()(int j) const {
    const int a = first[j];
    const int b = second[j];
    if (a < 0) return;
    const std::uint64_t worth = worth_of(id[j], frame);
    if (taken[a] != worth || taken[b] != worth) return;
    // Skips a relay for which another relay bids: another thread may be modifying it.
    if (taken[j]) return;
    const int kept = id[a] < id[b] ? a : b;
    const int left = kept == a ? b : a;
    const std::uint8_t* level = joining.level;
    if (level[a] + 1 < level[j]) {
      joining.join(kept, left);  // the relay does not change
    } else {
      share(j, kept, left);
    }
  }
  /// Merges `kept` and `left` with one half of relay j each. Index `kept` stores the first result, index j
  /// the second; `left` is removed.
  SIM_FN void share(int j, int kept, int left) const {
    const Vec4* x = joining.position;
    const Vec4* v = joining.velocity;
    const float lost = joining.loss(j, kept) + joining.loss(j, left);
    const float h = x[j].w;
    const int level = joining.level[j];
    const Vec3 x_left = joining.mean(x, j, left);
    const Vec3 v_left = joining.mean(v, j, left);
    joining.become(kept, joining.mean(x, j, kept), joining.mean(v, j, kept), h, level);
    joining.become(j, x_left, v_left, h, level);
    joining.descents.share(j, kept, left);
    joining.leave(left, lost);
  }
};

template <class Boundary>
void bid(LevelState& l, const LevelFluid& fluid, Boundary boundary) {
  const LevelView& p = fluid.particles;
  for_each_team("bid for stranded", p.size(),
                Bid<Boundary>{.position = p.position(),
                              .level = p.level(),
                              .target = p.target(),
                              .waiting = p.waiting(),
                              .wish = l.wish.data(),
                              .split_code = l.split_code.data(),
                              .gone = l.gone.data(),
                              .age = p.age(),
                              .id = p.id(),
                              .neighbours = fluid.neighbours,
                              .first = l.first_bid().data(),
                              .second = l.second_bid().data(),
                              .taken = l.taken_bids().data(),
                              .walls = boundary,
                              .rules = l.rules,
                              .supports = fluid.supports,
                              .frame = l.frame});
}

}  // namespace

void relay_stranded(LevelState& l, const LevelFluid& fluid, const Descents& descents) {
  const LevelView& p = fluid.particles;
  const int n = p.size();
  int* first = l.first_bid().data();
  int* second = l.second_bid().data();
  auto& taken = l.taken_bids();
  taken.resize(static_cast<std::size_t>(n));
  taken.zero();
  fluid.solids.count > 0 ? bid(l, fluid, fluid.solids) : bid(l, fluid, fluid.solids.walls);
  for_each("join halves", n,
           JoinHalves{joining(l, fluid, descents), p.id(), first, second, taken.data(), l.frame});
}

}  // namespace sim::SIM_BACKEND
