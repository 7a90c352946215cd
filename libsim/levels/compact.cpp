#include "libsim/levels/split_merge.hpp"
#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct CountBirths {
  const std::uint8_t* split_code;
  const std::uint8_t* gone;
  int* births;
  SIM_FN void operator()(int i) const {
    births[i] = gone[i] ? 0 : 1 << SplitCode::unpacked(split_code[i]).k;  // k = 0: stays
  }
};

/// sums holds the inclusive sum of births.
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

struct MarkFree {
  int* free;
  SIM_FN void operator()(int id) const { free[id] = 1; }
};
struct MarkTaken {
  const std::uint8_t* gone;
  const int* id;
  int* free;
  SIM_FN void operator()(int i) const {
    if (!gone[i]) free[id[i]] = 0;
  }
};
struct ListFree {
  const int* free;
  const int* sums;
  int* free_ids;
  SIM_FN void operator()(int id) const {
    if (free[id]) free_ids[sums[id] - 1] = id;
  }
};

struct MarkNew {
  const int* child;
  int* fresh;
  SIM_FN void operator()(int i) const { fresh[i] = child[i] > 0; }
};

/// Turns copies of the parent into children. The first keeps the parent's id, the others take free ones in
/// order.
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
  std::uint8_t* age;
  std::uint8_t* waiting;
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
    age[i] = 0;
    waiting[i] = 0;
    if (c > 0) {
      id[i] = free_ids[fresh_sums[i] - 1];
      atomic_add(&counts->born, std::uint64_t{1});
    } else {
      atomic_add(&counts->splits, std::uint64_t{1});
    }
  }
};

/// Lists the ids below the capacity that no living particle has, in ascending order.
void list_free_ids(FluidState& state) {
  auto& p = state.particles;
  auto& l = state.levels;
  const int capacity = p.capacity();
  const auto size = static_cast<std::size_t>(capacity);
  l.flags.resize(size);
  l.free_ids.resize(size);
  for_each("mark free ids", capacity, MarkFree{l.flags.data()});
  for_each("mark taken ids", p.size(), MarkTaken{l.gone.data(), p.id.data(), l.flags.data()});
  l.scanner.inclusive_sum(l.flags, l.sums);
  for_each("list free ids", capacity, ListFree{l.flags.data(), l.sums.data(), l.free_ids.data()});
}

/// Room for this frame's scratch; nothing moves once it is there.
void fit_scratch(LevelState& l, const Particles& p) {
  const auto room = static_cast<std::size_t>(p.capacity());
  const auto size = static_cast<std::size_t>(p.size());
  for (auto* bytes : {&l.status, &l.status_next, &l.split_code, &l.wish, &l.gone}) {
    bytes->reserve(room);
    bytes->resize(size);
  }
  for (auto* ints : {&l.partner, &l.births, &l.places, &l.order, &l.child, &l.flags, &l.sums, &l.free_ids}) {
    ints->reserve(room);
    ints->resize(size);
  }
  l.keys.reserve(room);
}

void split_and_merge(FluidState& state) {
  state.levels.changed = false;
  if (state.particles.size() == 0) return;
  fit_scratch(state.levels, state.particles);
  const bool any_split = choose_splits(state);
  merge_pairs(state);
  if (state.levels.rules.relays) relay_stranded(state);
  compact(state, any_split);
  ++state.levels.frame;
}

}  // namespace

void compact(FluidState& state, bool any_split) {
  auto& p = state.particles;
  auto& l = state.levels;
  const int n = p.size();
  for_each("count births", n, CountBirths{l.split_code.data(), l.gone.data(), l.births.data()});
  l.scanner.inclusive_sum(l.births, l.places);
  const int after = last_of(l.places);
  l.changed = any_split || after != n;
  if (!l.changed) return;
  if (any_split) list_free_ids(state);
  const auto size = static_cast<std::size_t>(after);
  l.order.resize(size);
  l.child.resize(size);
  for_each("list sources", n, ListSources{l.births.data(), l.places.data(), l.order.data(), l.child.data()});
  p.reorder(l.order);
  state.lists_hold = false;
  if (!any_split) return;
  l.flags.resize(size);
  for_each("mark new", after, MarkNew{l.child.data(), l.flags.data()});
  l.scanner.inclusive_sum(l.flags, l.sums);
  for_each("place children", after,
           PlaceChildren{l.order.data(), l.child.data(), l.split_code.data(), l.sums.data(),
                         l.free_ids.data(), p.position.data(), p.id.data(), p.level.data(), p.history.data(),
                         p.age.data(), p.waiting.data(), l.rules, state.supports, l.counts.data(), l.frame});
}

Stage split_and_merge_stage() {
  return {
      "split and merge",
      "Algorithms 1 and 2",
      Phase::FrameStart,
      columns(Column::Position, Column::Velocity, Column::Id, Column::Level, Column::Target, Column::History,
              Column::Age, Column::Waiting, Column::Neighbours),
      columns(Column::Position, Column::Velocity, Column::Id, Column::Level, Column::History, Column::Age,
              Column::Waiting),
      [](const Demand& demand) -> std::string { return demand.levels ? "particles split and merge" : ""; },
      split_and_merge,
      Part::Levels};
}

}  // namespace sim::SIM_BACKEND
