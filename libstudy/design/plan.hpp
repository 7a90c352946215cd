#pragma once
/// Plans which cells a participant sees in which order: a pure function of (protocol hash, participant, seed,
/// slot).

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
  int group = 0;                    ///< 0-based order of its group among the participant's groups
  int first = 0;                    ///< cell shown first, index into Design::cells
  std::optional<int> second;        ///< cell shown second; none: not a pair
  std::uint64_t schedule_seed = 0;  ///< orders the frame intervals; the second cell uses this + 1
};

/// One step of a session: a page (any block without trials, or the break between two groups) or a trial.
struct PlannedUnit {
  int position = 0;          ///< 0-based order in the session
  int block = 0;             ///< index into Protocol::blocks
  std::optional<int> trial;  ///< position of its trial; none for a page
};

struct Plan {
  int slot = 0;  ///< position in the assignment, 0 .. slot_count - 1
  std::vector<PlannedUnit> units;
  std::vector<PlannedTrial> trials;  ///< by position
};

/// Number of group sequences that the assignment deals in turn: all sequences of different scenes that spread
/// n_* as evenly as possible. 1 under Assignment::PaperRandom.
int sequence_count(const Protocol& protocol);

/// Number of slots before the assignment starts over: the sequences of groups times the rounds through them.
/// The rounds cover all rows of the square and, for pairs under Assignment::Balanced, both interval orders. 1
/// if nothing is balanced between people.
int slot_count(const Protocol& protocol);

/// The slot for the next participant: the first of the least used slots. `taken` lists the slots of all
/// sessions that count; a withdrawal or dropout leaves a gap, which is filled first.
int next_slot(const Protocol& protocol, const std::vector<int>& taken);

/// The groups of cells of a slot in order of presentation, as indices into cell_groups(). Under
/// Assignment::PaperRandom they are drawn with `key` instead.
std::vector<int> groups_met(const Protocol& protocol, int slot, std::uint64_t key);

/// A trial's schedule_seed depends on its cells and its block, not on its position; a repeat has the seed of
/// the trial it repeats. slot >= 0. base::Error if no order satisfies never_adjacent.
Plan make_plan(const Protocol& protocol, const std::string& participant, std::uint64_t seed, int slot);

}  // namespace study
