#include "libsim/levels/split_merge.hpp"

#include <algorithm>

namespace sim::SIM_BACKEND {

namespace {

/// State of a particle while splits are chosen. keeps: it does not split. paused: it may not split, because
/// the last frame did not solve it (ViP-Fluid, Alg. 3 line 16). wants: it wants to split, not yet decided.
/// splits: it is chosen.
enum Status : std::uint8_t { keeps, paused, wants, splits };

/// Priority of a split: first by k, the number of levels down to the target, because particles with a large k
/// are the most salient; then by a random number, drawn anew in each turn (update of the levels).
SIM_FN std::uint64_t priority(int k, int id, std::uint32_t frame) {
  const std::uint32_t chance = random_bits(static_cast<std::uint32_t>(id), frame, 0x5b1u);
  return static_cast<std::uint64_t>(k) << 62 | static_cast<std::uint64_t>(chance >> 2) << 32 |
         static_cast<std::uint32_t>(id);
}

struct MarkSplits {
  const std::uint8_t* level;
  const std::uint8_t* target;
  const std::uint8_t* active;
  std::uint8_t* status;
  bool throttled;
  SIM_FN void operator()(int i) const {
    status[i] = level[i] <= target[i] ? keeps : active && !active[i] ? paused : throttled ? wants : splits;
  }
};

/// One round of the selection of splits, in which no two particles within one spacing of each other are
/// chosen. A particle is chosen if it has the highest priority of all candidates within one spacing, and
/// excluded if one of them is chosen. The others stay undecided until the next round.
struct ChooseApart {
  const Vec4* position;
  const std::uint8_t* level;
  const std::uint8_t* target;
  const int* id;
  const std::uint8_t* status;
  ParticleNeighbours neighbours;
  std::uint8_t* out;
  std::uint32_t frame;

  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const std::uint8_t decided = status[i] == wants ? decide(i, team) : status[i];
    if (team.rank() == 0) out[i] = decided;
  }
  template <class Team>
  SIM_FN std::uint8_t decide(int i, Team team) const {
    const Vec4 self = position[i];
    const std::uint64_t own = priority(level[i] - target[i], id[i], frame);
    const int size = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    bool taken = false;
    bool late = false;
    for (int k = team.rank(); k < size && !taken; k += Team::size) {
      const int j = run[k];
      if (status[j] < wants) continue;
      const Vec4 other = position[j];
      const Vec3 offset = xyz(self) - xyz(other);
      const float spacing = 0.25f * (self.w + other.w);  // h = 2 d
      if (dot(offset, offset) >= spacing * spacing) continue;
      taken = status[j] == splits;
      late = late || priority(level[j] - target[j], id[j], frame) > own;
    }
    return team.any(taken) ? keeps : team.any(late) ? wants : splits;
  }
};

constexpr int rounds = 3;

/// Finds a rotation with which all 2^k children of a split lie inside the walls and outside obstacles. k is
/// the number of levels from the particle down to its target or, if no rotation fits, a smaller number.
template <class Boundary>
struct FitChildren {
  const Vec4* position;
  const std::uint8_t* level;
  const std::uint8_t* target;
  const int* id;
  const std::uint8_t* status;
  std::uint8_t* code;
  int* flags;
  Boundary walls;
  LevelRules rules;
  LevelSupports supports;
  LevelCounts* counts;
  std::uint32_t frame;
  float wall_gap;

  SIM_FN void operator()(int i) const {
    code[i] = 0;
    flags[i] = 0;
    if (level[i] <= target[i] || status[i] == paused) return;
    if (status[i] != splits) {
      atomic_add(&counts->split_deferred, std::uint64_t{1});
      return;
    }
    for (int k = level[i] - target[i]; k > 0; --k) {
      for (int attempt = 0; attempt < SplitCode::attempts; ++attempt) {
        const SplitCode wish{k, attempt};
        if (!fits(i, wish)) continue;
        code[i] = wish.packed();
        flags[i] = 1;
        return;
      }
    }
    atomic_add(&counts->split_at_wall, std::uint64_t{1});
  }
  SIM_FN bool fits(int i, SplitCode wish) const {
    const Vec4 self = position[i];
    const Turn turn = random_turn(id[i], frame, wish.attempt);
    const float gap = wall_gap * supports.h[level[i] - wish.k] / 2;
    for (int c = 0; c < 1 << wish.k; ++c) {
      if (!walls.holds(xyz(self) + child_offset(turn, rules, wish, self.w / 4, c), gap)) return false;
    }
    return true;
  }
};

struct ListSplits {
  const int* flags;
  const int* sums;
  const std::uint8_t* level;
  const std::uint8_t* target;
  const int* id;
  std::uint64_t* keys;
  int* order;
  std::uint32_t frame;
  SIM_FN void operator()(int i) const {
    if (!flags[i]) return;
    keys[sums[i] - 1] = ~priority(level[i] - target[i], id[i], frame);
    order[sums[i] - 1] = i;
  }
};

struct CountChildren {
  const int* order;
  const std::uint8_t* code;
  int* extra;
  SIM_FN void operator()(int rank) const {
    extra[rank] = (1 << SplitCode::unpacked(code[order[rank]]).k) - 1;
  }
};

/// Refuses splits beyond the maximum number per update of the levels, and splits whose children exceed the
/// capacity.
struct Refuse {
  const int* order;
  const int* extra_sums;
  std::uint8_t* code;
  LevelCounts* counts;
  int most, room;
  SIM_FN void operator()(int rank) const {
    const bool late = rank >= most;
    if (!late && extra_sums[rank] <= room) return;
    code[order[rank]] = 0;
    atomic_add(late ? &counts->split_deferred : &counts->split_no_room, std::uint64_t{1});
  }
};

/// Refuses all splits except the `most` with the highest priority. Also refuses splits whose additional
/// particles exceed `room`.
void limit(LevelState& l, LevelView p, int chosen, int most, int room) {
  l.keys.resize(static_cast<std::size_t>(chosen));
  l.order.resize(static_cast<std::size_t>(chosen));
  for_each("list splits", p.size(),
           ListSplits{.flags = l.flags.data(),
                      .sums = l.sums.data(),
                      .level = p.level(),
                      .target = p.target(),
                      .id = p.id(),
                      .keys = l.keys.data(),
                      .order = l.order.data(),
                      .frame = l.frame});
  l.sorter.sort(l.keys, l.order);
  l.flags.resize(static_cast<std::size_t>(chosen));
  for_each("count children", chosen, CountChildren{l.order.data(), l.split_code.data(), l.flags.data()});
  l.scanner.inclusive_sum(l.flags, l.sums);
  for_each("refuse splits", chosen,
           Refuse{.order = l.order.data(),
                  .extra_sums = l.sums.data(),
                  .code = l.split_code.data(),
                  .counts = l.counts.data(),
                  .most = most,
                  .room = room});
}

template <class Boundary>
void fit_children(LevelState& l, const LevelFluid& fluid, Boundary boundary) {
  const LevelView& p = fluid.particles;
  for_each("fit children", p.size(),
           FitChildren<Boundary>{.position = p.position(),
                                 .level = p.level(),
                                 .target = p.target(),
                                 .id = p.id(),
                                 .status = l.status.data(),
                                 .code = l.split_code.data(),
                                 .flags = l.flags.data(),
                                 .walls = boundary,
                                 .rules = l.rules,
                                 .supports = fluid.supports,
                                 .counts = l.counts.data(),
                                 .frame = l.frame,
                                 .wall_gap = fluid.wall_gap});
}

}  // namespace

bool choose_splits(LevelState& l, const LevelFluid& fluid) {
  const LevelView& p = fluid.particles;
  const int n = p.size();
  const bool throttled = l.rules.split_share < 1;
  for_each("mark splits", n,
           MarkSplits{p.level(), p.target(), fluid.last_active, l.status.data(), throttled});
  for (int round = 0; round < rounds && throttled; ++round) {
    for_each_team("choose splits", n,
                  ChooseApart{.position = p.position(),
                              .level = p.level(),
                              .target = p.target(),
                              .id = p.id(),
                              .status = l.status.data(),
                              .neighbours = fluid.neighbours,
                              .out = l.status_next.data(),
                              .frame = l.frame});
    l.status.swap(l.status_next);
  }
  fluid.solids.count > 0 ? fit_children(l, fluid, fluid.solids) : fit_children(l, fluid, fluid.solids.walls);
  l.scanner.inclusive_sum(l.flags, l.sums);
  const int chosen = last_of(l.sums);
  if (chosen == 0) return false;
  const int most = throttled ? std::max(1, static_cast<int>(l.rules.split_share * static_cast<float>(n))) : n;
  const int room = p.capacity() - n;
  constexpr int most_extra = 7;
  if (chosen > most || chosen > room / most_extra) limit(l, p, chosen, most, room);
  return true;
}

}  // namespace sim::SIM_BACKEND
