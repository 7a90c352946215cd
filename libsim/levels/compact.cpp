#include "libsim/levels/split_merge.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct CountBirths {
  const std::uint8_t* split_code;
  const std::uint8_t* gone;
  int* births;
  SIM_FN void operator()(int i) const {
    births[i] = gone[i] ? 0 : 1 << SplitCode::unpacked(split_code[i]).k;  // k = 0: no split
  }
};

/// Lists, for each particle of the new arrays, its source in the old arrays and its index among the particles
/// made from this source. `sums`: inclusive prefix sums of `births`.
struct ListSources {
  const int* births;
  const int* sums;
  int* order;
  int* child;
  SIM_FN void operator()(int i) const {
    const int first = sums[i] - births[i];
    for (int c = 0; c < births[i]; ++c) {
      order[first + c] = i;
      child[first + c] = c;
    }
  }
};

struct MarkNew {
  const int* child;
  int* fresh;
  SIM_FN void operator()(int i) const { fresh[i] = child[i] > 0; }
};

/// Converts copies of the parent into children. The first child keeps the parent's id; the others take free
/// ids in ascending order.
struct PlaceChildren {
  const int* order;
  const int* child;
  const std::uint8_t* split_code;
  const int* fresh_sums;
  const int* free_ids;
  Vec4* position;
  int* id;
  std::uint8_t* level;
  std::uint8_t* history;
  Descents descents;
  LevelRules rules;
  LevelSupports supports;
  LevelCounts* counts;
  std::uint32_t frame;

  SIM_FN void operator()(int i) const {
    const std::uint8_t packed = split_code[order[i]];
    if (!packed) return;
    const SplitCode code = SplitCode::unpacked(packed);
    const int c = child[i];
    const Vec4 parent = position[i];
    const int finer = level[i] - code.k;
    const Turn turn = random_turn(id[i], frame, code.attempt);
    position[i] = with_w(xyz(parent) + child_offset(turn, rules, code, parent.w / 4, c), supports.h[finer]);
    level[i] = static_cast<std::uint8_t>(finer);
    history[i] = steady_history(finer);
    descents.split(i, 1 << code.k);
    if (c > 0) {
      id[i] = free_ids[fresh_sums[i] - 1];
      atomic_add(&counts->born, std::uint64_t{1});
    } else {
      atomic_add(&counts->splits, std::uint64_t{1});
    }
  }
};

struct GrowOlder {
  std::uint8_t* age;
  SIM_FN void operator()(int i) const { age[i] = static_cast<std::uint8_t>(age[i] < 255 ? age[i] + 1 : 255); }
};

/// Sizes the scratch arrays for this frame. They have memory for the maximum number of particles, so that
/// later calls do not reallocate.
void fit_scratch(LevelState& l, LevelView p) {
  const auto room = static_cast<std::size_t>(p.capacity());
  const auto size = static_cast<std::size_t>(p.size());
  for (auto* bytes : {&l.status, &l.status_next, &l.split_code, &l.wish, &l.gone}) {
    bytes->reserve(room);
    bytes->resize(size);
  }
  for (auto* ints : {&l.partner, &l.births, &l.places, &l.order, &l.child, &l.flags, &l.sums}) {
    ints->reserve(room);
    ints->resize(size);
  }
  l.keys.reserve(room);
}

}  // namespace

void grow_older(LevelState& l, const LevelView& p) {
  l.changed = false;
  for_each("grow older", p.size(), GrowOlder{p.age()});
}

void split_and_merge(LevelState& l, const LevelFluid& fluid, Particles& particles) {
  l.changed = false;
  if (particles.size() == 0) return;
  fit_scratch(l, fluid.particles);
  const bool any_split = choose_splits(l, fluid);
  merge_pairs(l, fluid, particles.descents());
  if (l.rules.relays) relay_stranded(l, fluid, particles.descents());
  compact(l, fluid, particles, any_split);
  ++l.frame;
}

void compact(LevelState& l, const LevelFluid& fluid, Particles& particles, bool any_split) {
  const LevelView& p = fluid.particles;
  const int n = p.size();
  for_each("count births", n, CountBirths{l.split_code.data(), l.gone.data(), l.births.data()});
  l.scanner.inclusive_sum(l.births, l.places);
  const int after = last_of(l.places);
  l.changed = any_split || after != n;
  if (!l.changed) return;
  if (any_split) list_free_ids(p, l.gone.data(), l.scanner, l.flags, l.sums, l.free_ids);
  const auto size = static_cast<std::size_t>(after);
  l.order.resize(size);
  l.child.resize(size);
  for_each("list sources", n, ListSources{l.births.data(), l.places.data(), l.order.data(), l.child.data()});
  particles.reorder(l.order);
  if (!any_split) return;
  l.flags.resize(size);
  for_each("mark new", after, MarkNew{l.child.data(), l.flags.data()});
  l.scanner.inclusive_sum(l.flags, l.sums);
  for_each("place children", after,
           PlaceChildren{.order = l.order.data(),
                         .child = l.child.data(),
                         .split_code = l.split_code.data(),
                         .fresh_sums = l.sums.data(),
                         .free_ids = l.free_ids.data(),
                         .position = p.position(),
                         .id = p.id(),
                         .level = p.level(),
                         .history = p.history(),
                         .descents = particles.descents(),
                         .rules = l.rules,
                         .supports = fluid.supports,
                         .counts = l.counts.data(),
                         .frame = l.frame});
}

}  // namespace sim::SIM_BACKEND
