#include "libsim/levels/split_merge.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Two members of a merge that find each other through a particle of twice their mass between them: its
/// halves join one each, and three particles of masses 1, 2, 1 become two of mass 2. No step is longer than a
/// merge's, and the last few of a level, which are too far apart for pairs, need not stay behind.
struct Bid {
  const Vec4* position;
  const std::uint8_t* level;
  const std::uint8_t* target;
  const std::uint8_t* waiting;
  const std::uint8_t* wish;
  const std::uint8_t* split_code;
  const std::uint8_t* gone;
  const std::uint8_t* age;
  Neighbours neighbours;
  int* first;
  int* second;
  LevelRules rules;

  /// A particle that has waited without a partner and is still there.
  SIM_FN bool stranded(int i) const {
    return wish[i] && !gone[i] && age[i] > 0 && waiting[i] >= rules.looks_farther;
  }
  /// The relay names its nearest two stranded neighbours of half its mass that lie far enough from each
  /// other.
  SIM_FN void operator()(int j) const {
    first[j] = second[j] = -1;
    if (level[j] == 0 || target[j] < level[j] || split_code[j] || gone[j] || age[j] == 0) return;
    if (neighbours.size(j) < rules.inside_count) return;
    first[j] = nearest(j, -1);
    if (first[j] >= 0) second[j] = nearest(j, first[j]);
    if (second[j] < 0) first[j] = -1;
  }
  SIM_FN int nearest(int j, int other) const {
    const Vec4 self = position[j];
    const float support = 0.5f * self.w * (1 + 0.7937f);  // hbar of levels l + 1 and l
    int best = -1;
    for (int k = 0; k < neighbours.size(j); ++k) {
      const int i = neighbours(j, k);
      if (i == other || level[i] + 1 != level[j] || !stranded(i)) continue;
      const Vec3 offset = xyz(self) - xyz(position[i]);
      const float distance2 = dot(offset, offset);
      if (distance2 >= support * support || (best >= 0 && distance2 >= dot_to(j, best))) continue;
      if (other >= 0 && !apart(i, other, self.w)) continue;
      best = i;
    }
    return best;
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
  Neighbours neighbours;
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
  float rest_density;

  SIM_FN void operator()(int j) const {
    const int a = first[j];
    const int b = second[j];
    if (a < 0 || accepted[a] != j || accepted[b] != j) return;
    const int kept = id[a] < id[b] ? a : b;
    const int left = kept == a ? b : a;
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
  for_each(
      "bid for stranded", n,
      Bid{p.position.data(), p.level.data(), p.target.data(), p.waiting.data(), l.wish.data(),
          l.split_code.data(), l.gone.data(), p.age.data(), state.neighbours.view(), first, second, l.rules});
  for_each("accept bids", n,
           AcceptBid{p.id.data(), first, second, state.neighbours.view(), accepted, l.frame});
  for_each("join halves", n,
           JoinHalves{p.position.data(), p.velocity.data(), p.level.data(), p.history.data(), p.age.data(),
                      p.waiting.data(), p.id.data(), first, second, accepted, l.gone.data(), l.counts.data(),
                      state.parameters.rest_density});
}

}  // namespace sim::SIM_BACKEND
