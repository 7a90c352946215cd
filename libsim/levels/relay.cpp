#include "libsim/levels/joining.hpp"

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
    return clear_of(position[j], centre, h, rules.stranded_overlap) &&
           !overlaps_coarser(position, level, neighbours, j, level[a], centre, h, rules.stranded_overlap);
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
  Joining joining;
  const int* id;
  const int* first;
  const int* second;
  const int* accepted;

  SIM_FN void operator()(int j) const {
    const int a = first[j];
    const int b = second[j];
    if (a < 0 || accepted[a] != j || accepted[b] != j) return;
    // A relay that has accepted a bid itself may be changed by it at this moment.
    if (accepted[j] >= 0) return;
    const int kept = id[a] < id[b] ? a : b;
    const int left = kept == a ? b : a;
    const std::uint8_t* level = joining.level;
    if (level[a] + 1 < level[j]) {
      joining.join(kept, left);  // the relay only made them known to each other
    } else {
      share(j, kept, left);
    }
  }
  /// Each takes a half of the relay, which goes on as one of the two.
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
    joining.leave(left, lost);
  }
};

}  // namespace

void relay_stranded(LevelState& l, const LevelFluid& fluid) {
  const LevelView& p = fluid.particles;
  const int n = p.size();
  int* first = l.first_bid().data();
  int* second = l.second_bid().data();
  int* accepted = l.partner.data();
  for_each("bid for stranded", n,
           Bid{.position = p.position(),
               .level = p.level(),
               .target = p.target(),
               .waiting = p.waiting(),
               .wish = l.wish.data(),
               .split_code = l.split_code.data(),
               .gone = l.gone.data(),
               .age = p.age(),
               .neighbours = fluid.neighbours,
               .first = first,
               .second = second,
               .walls = fluid.walls,
               .rules = l.rules,
               .supports = fluid.supports});
  for_each("accept bids", n, AcceptBid{p.id(), first, second, fluid.neighbours, accepted, l.frame});
  for_each("join halves", n, JoinHalves{joining(l, fluid), p.id(), first, second, accepted});
}

}  // namespace sim::SIM_BACKEND
