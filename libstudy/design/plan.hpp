#pragma once
/// Plans the cells that a participant sees and their order. The plan is a pure function of (protocol hash,
/// participant, seed, slot). A slot is a place in the assignment of groups and orders of cells to
/// participants.

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
  int block = 0;                    ///< index into Protocol::blocks: a practice, stimulus or repeat block
  int group = 0;                    ///< 0-based position of its group of cells among the participant's groups
  int first = 0;                    ///< cell shown first, index into Design::cells
  std::optional<int> second;        ///< cell shown second; none: not a pair
  std::uint64_t schedule_seed = 0;  ///< seed for the order of frame intervals; second cell: this value + 1
};

/// One step of a session: a trial or a page. A page is a block without trials, a catch page, or a break in a
/// stimulus block (between two groups or after every break_every trials).
struct PlannedUnit {
  int position = 0;          ///< 0-based order in the session
  int block = 0;             ///< index into Protocol::blocks
  std::optional<int> trial;  ///< PlannedTrial::position of the unit's trial; none for a page
};

struct Plan {
  int slot = 0;  ///< position in the assignment, 0 .. slot_count - 1
  std::vector<PlannedUnit> units;
  std::vector<PlannedTrial> trials;  ///< in the order of their positions
};

/// Number of sequences of cell groups that the assignment deals to participants in turn. They are all
/// sequences of groups with different scenes that spread n_* (the size of the fluid) as evenly as possible.
/// 1 under Assignment::PaperRandom, which draws a sequence at random for each participant.
int sequence_count(const Protocol& protocol);

/// Number of slots before the assignment starts over: number of group sequences x number of rounds through
/// them. The rounds cover all rows of the square (Latin or Williams) and, for pairs under
/// Assignment::Balanced, both interval orders. 1 if nothing is balanced between people.
int slot_count(const Protocol& protocol);

/// The slot for the next participant: the lowest of the least used slots. `taken` lists the slots of all
/// sessions that count (Store::taken_slots()). So a slot of a person who withdrew or dropped out is assigned
/// again before unused slots.
int next_slot(const Protocol& protocol, const std::vector<int>& taken);

/// The groups of cells that a participant in this slot sees, in order of presentation, as indices into
/// cell_groups(). Under Assignment::PaperRandom the groups are drawn with `key`, the participant's random
/// key, and the slot has no effect.
std::vector<int> groups_met(const Protocol& protocol, int slot, std::uint64_t key);

/// Plans a whole session. A trial's schedule_seed depends on its cells, its block and the number of its
/// repetition, not on its position. For an adaptive procedure, the trial's number within its group replaces
/// the repetition. A trial of a repeat block has the schedule_seed of the trial that it repeats. slot >= 0.
/// base::Error if no order of trials was found that satisfies never_adjacent.
Plan make_plan(const Protocol& protocol, const std::string& participant, std::uint64_t seed, int slot);

}  // namespace study
