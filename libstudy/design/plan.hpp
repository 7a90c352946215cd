#pragma once
/// Who sees what in which order: a pure function of (protocol hash, participant, seed, slot).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/base/random.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// One planned trial.
struct PlannedTrial {
  int position = 0;                 ///< 0-based order of presentation among the session's trials
  int block = 0;                    ///< index into Protocol::blocks: practice, stimulus, repeat or catch
  int group = 0;                    ///< 0-based order of its group among those that the participant meets
  int first = 0;                    ///< cell shown first, index into Design::cells
  std::optional<int> second;        ///< cell shown second, of a pair
  std::uint64_t schedule_seed = 0;  ///< orders the intervals; of the second cell: this + 1
};

/// What a session goes through, one after another: a page (any block without trials, or the break between two
/// groups) or a trial.
struct PlannedUnit {
  int position = 0;          ///< 0-based order in the session
  int block = 0;             ///< index into Protocol::blocks
  std::optional<int> trial;  ///< position of its trial; none: a page
};

struct Plan {
  int slot = 0;  ///< place in the assignment, 0 .. slot_count - 1
  std::vector<PlannedUnit> units;
  std::vector<PlannedTrial> trials;  ///< by position
};

/// Orders of groups that the assignment deals out in turn: every one with different scenes that spreads n_*
/// as evenly as any. 1 under Assignment::PaperRandom.
int sequence_count(const Protocol& protocol);

/// Different places that the assignment deals out before it starts over: rounds through all sequences of
/// groups, as many as there are rows of the square and, for pairs under Assignment::Balanced, both interval
/// orders. 1 where nothing is balanced between people.
int slot_count(const Protocol& protocol);

/// The slot for the next participant: the first of those that are least taken. `taken` lists the slots of all
/// sessions that count; whoever was withdrawn or dropped out leaves a gap, which is filled first.
int next_slot(const Protocol& protocol, const std::vector<int>& taken);

/// The groups of cells that a slot stands for, in the order in which they are met, as indices of
/// cell_groups(). Under Assignment::PaperRandom they are drawn with `key` instead.
std::vector<int> groups_met(const Protocol& protocol, int slot, std::uint64_t key);

/// A trial's schedule_seed depends on its cells and its block, not on its position; a repeat has that of the
/// trial it repeats. slot >= 0. base::Error when no order keeps never_adjacent.
Plan make_plan(const Protocol& protocol, const std::string& participant, std::uint64_t seed, int slot);

}  // namespace study
