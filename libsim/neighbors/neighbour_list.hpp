#pragma once
/// One neighbour list per particle and substep, with a margin, read by all passes of the substep; iterations
/// never search the grid.

#include "libsim/neighbors/grid.hpp"
#include "libsim/particles/selection.hpp"

namespace sim::SIM_BACKEND {

#ifdef SIM_CUDA
/// Lists of 32 consecutive particles are interleaved, so that a warp reads contiguous memory.
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
  static constexpr int stride = 1;  // known at compile time, so that several entries load at once
#endif
  SIM_FN int operator[](int k) const { return first[k * stride]; }
};

/// The lists in the form that kernels use. A list longer than its own space is stored completely in a common
/// store; its first entry is then its index in the store. i is a slot of the reading pass
/// (particles/selection.hpp): the particle itself if all particles are solved.
struct Neighbours {
  const int* count;
  const int* entry;
  const int* store;
  int capacity;
  SIM_FN int size(int i) const { return count[i]; }
  /// Number of neighbours that fit in a list's own space. Its last entry is never read as a neighbour: on the
  /// CPU the search writes all surplus neighbours there. A longer list is then searched again and written to
  /// the store.
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

/// Neighbour lists by particle, for the few passes at a frame's start. slot_of: each particle's slot in the
/// last substep (particles/selection.hpp), which is the index of its list; nullptr: that is the particle's
/// own index.
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
  /// Search radius as a multiple of the pair's support radius, so that lists remain complete while particles
  /// move within a substep.
  static constexpr float margin = 1.1f;

  /// Lists every j != i within margin x (h_i + h_j) / 2 of particle i, in the same order in every run; on the
  /// CPU this is the grid's order. Lists longer than the capacity go to the store, memory that all lists
  /// share; neighbours that do not fit there either are dropped and reported to the witness.
  void build(PredictedView particles, const Grid& grid, Witness witness);
  /// Lists the neighbours of the active particles only, one list per slot (particles/selection.hpp).
  void build(PredictedView particles, const Grid& grid, ActiveParticles active, Witness witness);
  /// Lists the neighbours of all particles, active or not, one list per slot.
  void build(PredictedView particles, const Grid& grid, EverySlot everyone, Witness witness);
  /// Replaces the lists by the given ones, each within most_capacity; for tests.
  void assign(const std::vector<std::vector<int>>& lists);
  /// Every slot's list, for tests.
  std::vector<std::vector<int>> lists() const;
  Neighbours view() const { return {count_.data(), entry_.data(), store_.data(), capacity_}; }

  /// The space that long lists requested in the store, memory that all lists share.
  struct Need {
    int longest;           ///< longest list that went to the store since grow() last added space, in entries
    std::uint64_t stored;  ///< store entries requested by the last build
  };
  /// Reads the need back and allocates space: the store grows to twice the requested entries if they did not
  /// fit, and lists get at most a quarter more space, up to `most_capacity` entries, if much was stored. True
  /// if store or lists grew; the lists' contents are then lost.
  bool grow();
  /// grow() with a need that the caller has read.
  bool grow(Need met);
  /// The need in the back end's memory; nullptr before the first build.
  const Need* need() const { return need_.data(); }
  static constexpr int most_capacity = 512;
  int capacity() const { return capacity_; }
  /// Saves or restores what lasts beyond a frame (libsim/solver/state_archive.hpp): the capacity of a list,
  /// the size of the store and the need. with_lists: also the neighbours in the lists; set it only if the
  /// lists are still valid. Unused entries are not saved.
  template <class Archive>
  void keep(Archive& archive, bool with_lists) {
    std::uint64_t store = store_.size();
    archive(capacity_, store, need_);
    if constexpr (Archive::reads) {
      if (capacity_ < 2 || capacity_ > most_capacity || store > most_store)
        Archive::fail("contains neighbour lists of an impossible length");
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
  /// Entries per list for particles of one level: a particle has 40 neighbours within the margin, and at most
  /// 55 in SingleDam.
  static constexpr int usual_capacity = 56;
  /// Entries per list for mixed levels. A coarse particle among the finest has 113 neighbours within the
  /// support and some 150 within the margin. The longest list of ViP-Fluid's three scenes had 108 (method
  /// Ours, n_* = 32k).
#ifdef SIM_CUDA
  static constexpr int mixed_capacity = 128;
#else
  // Smaller on the CPU: each pass reads all lists in order, and unused space in a list delays the prefetch of
  // the next list.
  static constexpr int mixed_capacity = 72;
#endif
  /// grow() gives each list more space if the store has more than one entry per this many lists. Reading a
  /// few long lists from the store costs nothing measurable, but more space enlarges every list.
  static constexpr std::size_t most_stored = 4;
  /// Smallest store: 4 MB, enough for the lists of a thousand particles at one position.
  static constexpr std::size_t least_store = 1 << 20;
  static constexpr std::size_t most_store = 1 << 26;

  /// Fills the lists from their entries, stored list by list.
  void put_back(const std::vector<int>& counts, const std::vector<int>& entries);

  template <class Selection>
  void list(PredictedView particles, const Grid& grid, Selection select, Witness witness);

  int capacity_ = usual_capacity;
  Array<int> count_, entry_, store_;
  Array<Need> need_;
};

}  // namespace sim::SIM_BACKEND
