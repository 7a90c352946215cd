#pragma once
/// One list of neighbours a substep, with a margin, that all passes of the substep read; iterations never
/// walk the grid.

#include "libsim/neighbors/grid.hpp"
#include "libsim/particles/selection.hpp"

namespace sim::SIM_BACKEND {

#ifdef SIM_CUDA
/// Lists of 32 consecutive particles interleave, so that a warp reads whole lines.
constexpr int list_interleave = 32;
#else
constexpr int list_interleave = 1;
#endif

/// One particle's neighbours.
struct NeighbourRun {
  const int* first;
#ifdef SIM_CUDA
  int stride;
#else
  static constexpr int stride = 1;  // known to the compiler, which loads several at once
#endif
  SIM_FN int operator[](int k) const { return first[k * stride]; }
};

/// The list as kernels see it. A list that is longer than its room lies whole in a common store, and its
/// first entry says where. i is a slot of the pass that reads it (particles/selection.hpp): the particle
/// itself while everyone is solved.
struct Neighbours {
  const int* count;
  const int* entry;
  const int* store;
  int capacity;
  SIM_FN int size(int i) const { return count[i]; }
  /// The longest list that has room of its own: the last place only takes what is not kept.
  SIM_FN int room() const { return capacity - 1; }
  SIM_FN std::size_t place(int i, int k) const {
    const int group = i / list_interleave;
    const int lane = i % list_interleave;
    return (static_cast<std::size_t>(group) * static_cast<std::size_t>(capacity) +
            static_cast<std::size_t>(k)) *
               list_interleave +
           static_cast<std::size_t>(lane);
  }
  SIM_FN NeighbourRun run(int i) const {
    const int* first = entry + place(i, 0);
    const bool stored = count[i] > room();
#ifdef SIM_CUDA
    return {stored ? store + *first : first, stored ? 1 : list_interleave};
#else
    return {stored ? store + *first : first};
#endif
  }
  SIM_FN int operator()(int i, int k) const { return run(i)[k]; }
};

/// The list of particle i where lists belong to slots that were chosen in the last substep; slot_of is null
/// where a slot is a particle. For passes at a frame's start, which are few.
struct ParticleNeighbours {
  Neighbours list;
  const int* slot_of;
  SIM_FN int slot(int i) const { return slot_of ? slot_of[i] : i; }
  SIM_FN int size(int i) const { return list.size(slot(i)); }
  SIM_FN NeighbourRun run(int i) const { return list.run(slot(i)); }
  SIM_FN int operator()(int i, int k) const { return list(slot(i), k); }
};

using PredictedView = Reads<Column::Predicted>;

class NeighbourList {
 public:
  /// Search radius as a multiple of the pair's support radius, so that pairs may move within a substep.
  static constexpr float margin = 1.1f;

  /// Lists every j != i within margin x (h_i + h_j) / 2 of particle i, in the grid's order. Lists beyond the
  /// capacity go to the store; what finds no room there either is left out and told to the witness.
  void build(PredictedView particles, const Grid& grid, Witness witness);
  /// For the active particles only, a list for each of their slots.
  void build(PredictedView particles, const Grid& grid, ActiveParticles active, Witness witness);
  /// The same with lists for the others' slots too.
  void build(PredictedView particles, const Grid& grid, EverySlot everyone, Witness witness);
  /// Takes lists made elsewhere, each within most_capacity; a test's way in.
  void assign(const std::vector<std::vector<int>>& lists);
  /// Every slot's list, for tests.
  std::vector<std::vector<int>> lists() const;
  Neighbours view() const { return {count_.data(), entry_.data(), store_.data(), capacity_}; }

  /// What lists asked for that had no room of their own.
  struct Need {
    int longest;           ///< since the lists grew last
    std::uint64_t stored;  ///< entries of the store that the last build asked for
  };
  /// Reads the need back and makes room for it: the store holds what was asked of it, and lists get a quarter
  /// more room, up to `most_capacity` entries, where much was. True when it grew.
  bool grow();
  /// The same with the need as need() had it.
  bool grow(Need met);
  /// In the back end's memory; nullptr before the first build.
  const Need* need() const { return need_.data(); }
  static constexpr int most_capacity = 512;
  int capacity() const { return capacity_; }
  /// What outlives a frame (libsim/solver/state_archive.hpp): how far the lists have grown and, where they
  /// hold, the lists themselves. Room that nothing uses is left out.
  template <class Archive>
  void keep(Archive& archive, bool with_lists) {
    std::uint64_t store = store_.size();
    archive(capacity_, store, need_);
    if constexpr (Archive::reads) {
      if (capacity_ < 2 || capacity_ > most_capacity || store > most_store)
        Archive::fail("holds lists of neighbours of no length");
      store_.resize(static_cast<std::size_t>(store));
    }
    if (!with_lists) return;
    std::vector<int> counts = count_.to_host();
    std::vector<int> entries;
    if constexpr (!Archive::reads)
      for (const auto& list : lists()) entries.insert(entries.end(), list.begin(), list.end());
    archive(counts, entries);
    if constexpr (Archive::reads) put_back(counts, entries);
  }

 private:
  /// Of water of one size: a particle has 40 within the margin, and 55 at most in SingleDam.
  static constexpr int usual_capacity = 56;
  /// A coarse particle among the finest has 113 within the support and some 150 within the margin. The
  /// longest list of the three scenes had 108 (Ours, n_* = 32k).
#ifdef SIM_CUDA
  static constexpr int mixed_capacity = 128;
#else
  // Each pass walks all rows: what nobody fills of one keeps the next from being fetched in time.
  static constexpr int mixed_capacity = 72;
#endif
  /// The store may hold one entry for so many lists before all lists get more room: few long ones are read
  /// from it at no cost that shows, and room of their own is room in every list.
  static constexpr std::size_t most_stored = 4;
  /// A thousand particles in one place, 4 MB.
  static constexpr std::size_t least_store = 1 << 20;
  static constexpr std::size_t most_store = 1 << 26;

  /// Fills the lists from their entries, one list after the other.
  void put_back(const std::vector<int>& counts, const std::vector<int>& entries);

  template <class Selection>
  void list(PredictedView particles, const Grid& grid, Selection select, Witness witness);

  int capacity_ = usual_capacity;
  Array<int> count_, entry_, store_;
  Array<Need> need_;
};

}  // namespace sim::SIM_BACKEND
