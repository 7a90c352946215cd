#include "libsim/neighbors/neighbour_list.hpp"

#include <algorithm>
#include <atomic>

#include "libsim/neighbors/candidates.hpp"
#include "stats/base/error.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct EmptyStore {
  NeighbourList::Need* need;
  SIM_FN void operator()(int) const { need->stored = 0; }
};

template <class Selection>
struct ListNeighbours {
  Selection select;
  const Vec4* predicted;
  CellTable cells;
  Neighbours list;
  int* entry;
  int* count;
  int* store;
  std::size_t store_size;
  NeighbourList::Need* need;
  Witness witness;
  float margin;
  std::uint64_t build;  ///< number of this build, which no other build of lists has (Candidates::gather)

#ifdef SIM_CUDA
  /// Threads per particle for n particles; the limits were measured on an H200. With several levels a
  /// particle reads more lines of cells, so several threads per particle are faster up to a larger n.
  int lanes(int n) const { return n < 20'000 ? 8 : n < (cells.levels > 1 ? 300'000 : 110'000) ? 4 : 1; }

  /// Bit mask of the near particles among up to 32 from index `begin` on.
  struct Found {
    int begin;
    unsigned near_ones;
  };
  /// Number of bit masks that a lane collects before all lanes together assign positions in the list to the
  /// neighbours found.
  static constexpr int most_noted = 8;

  /// State of a lane's search: its next line of cells, the number of lines left, and the rest of the previous
  /// line.
  struct Way {
    int y, z, lines;
    IndexRange run;
    SIM_FN bool left() const { return lines > 0 || run.begin < run.end; }
  };

  /// Finds the neighbours of particle i and returns their number. Each lane searches its share of a grid's
  /// lines, one after another.
  template <class Team>
  SIM_FN int look(int slot, int i, Vec4 self, Team team) const {
    int found = 0;
    for (int l = 0; l < cells.levels; ++l) {
      if (!cells.meets(self, l)) continue;
      const LevelCells grid = cells.level[l];
      const float radius = margin * 0.5f * (self.w + grid.support);
      const CellTable::Window window = cells.window(grid, self, margin);
      const int width = window.last_z - window.first_z + 1;
      const int lines = width * (window.last_y - window.first_y + 1);
      const int first = lines * team.rank() / Team::size;
      const int row = first / width;
      Way way{window.first_y + row,
              window.first_z + first - row * width,
              lines * (team.rank() + 1) / Team::size - first,
              {0, 0}};
      do {
        found = note_and_list(slot, i, self, radius * radius, team, grid, window, way, found);
      } while (team.any(way.left()));
    }
    return found;
  }

  template <class Team>
  SIM_FN int note_and_list(int slot, int i, Vec4 self, float square, Team team, const LevelCells& grid,
                           const CellTable::Window& window, Way& way, int found) const {
#ifdef __CUDA_ARCH__
    __shared__ Found memory[most_noted * block_threads];
    Found* const noted = memory + threadIdx.x;
    int held = 0;
    int count = 0;
    while (held < most_noted && way.left()) {
      if (way.run.begin >= way.run.end) {
        way.run = cells.line(grid, window, way.y, way.z);
        --way.lines;
        if (++way.z > window.last_z) {
          way.z = window.first_z;
          ++way.y;
        }
      }
      if (way.run.begin < way.run.end) {
        const unsigned bits = near_ones(i, self, square, way.run);
        noted[held * block_threads] = {way.run.begin, bits};
        held += bits != 0;
        count += __popc(bits);
        way.run.begin += 32;
      }
    }
    int all;
    const int place = found + team.offset(count, all);
    int* next = entry + list.place(slot, place);
    const int* const end = next + (list.capacity - place) * list_interleave;
    for (int k = 0; k < held; ++k) {
      Found now = noted[k * block_threads];
      for (; now.near_ones != 0 && next < end; next += list_interleave) {
        *next = now.begin + __ffs(static_cast<int>(now.near_ones)) - 1;
        now.near_ones &= now.near_ones - 1;
      }
    }
    return found + all;
#else
    return found;
#endif
  }

  /// Bit mask of the near particles among the run's next 32, without i. Particles are loaded eight at a time,
  /// so that their loads overlap.
  SIM_FN unsigned near_ones(int i, Vec4 self, float square, IndexRange run) const {
    constexpr int at_once = 8;
    constexpr float far = 1e30f;
    const int size = run.end - run.begin < 32 ? run.end - run.begin : 32;
    unsigned out = 0;
#pragma unroll 1
    for (int first = 0; first < size; first += at_once) {
      Vec4 other[at_once];
#pragma unroll
      for (int k = 0; k < at_once; ++k) {
        other[k] = Vec4{far, far, far, 0};
        if (first + k < size) other[k] = predicted[run.begin + first + k];
      }
      unsigned bits = 0;
#pragma unroll
      for (int k = 0; k < at_once; ++k) {
        const Vec3 offset = xyz(self) - xyz(other[k]);
        bits |= dot(offset, offset) < square ? 1u << k : 0u;
      }
      out |= bits << first;
    }
    const auto own = static_cast<unsigned>(i - run.begin);
    return own < 32 ? out & ~(1u << own) : out;
  }
#else
  /// Finds the neighbours of particle i and returns their number, from candidates shared by the particles of
  /// one cell.
  template <class Team>
  int look(int slot, int i, Vec4 self, Team) const {
    thread_local Candidates shared[LevelSupports::most];
    int* const own = entry + list.place(slot, 0);
    const int last = list.capacity - 1;
    int place = 0;
    for (int l = 0; l < cells.levels; ++l) {
      if (!cells.meets(self, l)) continue;
      const float radius = margin * 0.5f * (self.w + cells.level[l].support);
      shared[l].gather(cells, l, self, margin, predicted, build);
      shared[l].each_near(self, radius * radius, [&](int j) {
        if (j == i) return;
        own[place < last ? place : last] = j;
        ++place;
      });
    }
    return place;
  }
#endif

  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) return;
    }
    const Vec4 self = predicted[i];
    const int found = look(slot, i, self, team);
    team.wait();
    if (team.rank() > 0) return;
    count[slot] = found;
    if (found > list.room()) put_in_store(slot, i, self, found);
  }

  struct Put {
    const ListNeighbours& task;
    int i;
    Vec4 self;
    int* next;
    const int* end;  ///< end of the reserved space
    SIM_FN void operator()(int from, int to) {
      for (int j = from; j < to; ++j) {
        if (j != i && next < end && task.near(self, task.predicted[j])) *next++ = j;
      }
    }
  };

  /// Searches again for a list that exceeds its own space, and writes it to the store. This is rare; one lane
  /// suffices.
  SIM_FN void put_in_store(int slot, int i, Vec4 self, int found) const {
    atomic_max(&need->longest, found);
    const std::uint64_t first = atomic_take(&need->stored, static_cast<std::uint64_t>(found));
    if (first + static_cast<std::uint64_t>(found) > store_size) {
      atomic_add(&witness.guards->neighbours_dropped, static_cast<std::uint64_t>(found - list.room()));
      witness.note(Trouble::NeighboursDropped, i);
      count[slot] = list.room();
      return;
    }
    int* const begin = store + first;
    Put put{*this, i, self, begin, begin + found};
    cells.around(self, margin, [&put](int from, int to) { put(from, to); });
    // Because of rounding, the first search may have counted a pair exactly at the margin that this search
    // omits, or the reverse.
    const int put_there = static_cast<int>(put.next - begin);
    count[slot] = put_there;
    if (put_there > list.room()) {
      entry[list.place(slot, 0)] = static_cast<int>(first);
    } else {
      for (int k = 0; k < put_there; ++k) entry[list.place(slot, k)] = begin[k];
    }
  }

  SIM_FN bool near(Vec4 self, Vec4 other) const {
    const Vec3 offset = xyz(self) - xyz(other);
    const float radius = margin * 0.5f * (self.w + other.w);
    return dot(offset, offset) < radius * radius;
  }
};

/// Counts the builds of all lists, so that a thread's cached candidates are never used for another list.
std::atomic<std::uint64_t> builds = 0;

}  // namespace

template <class Selection>
void NeighbourList::list(PredictedView particles, const Grid& grid, Selection select, Witness witness) {
  const CellTable cells = grid.cells();
  if (cells.levels > 1) capacity_ = std::max(capacity_, mixed_capacity);
  const auto n = static_cast<std::size_t>(particles.size());
  const auto room = static_cast<std::size_t>(particles.capacity());
  const auto entries = [&](std::size_t size) {
    const std::size_t groups = (size + list_interleave - 1) / list_interleave;
    return groups * list_interleave * static_cast<std::size_t>(capacity_);
  };
  count_.reserve(room);
  entry_.reserve(entries(room));
  count_.resize(n);
  entry_.resize(entries(n));
  if (need_.size() == 0) {
    store_.resize(least_store);
    need_.from_host({{0, 0}});
  }
  for_each("empty store", 1, EmptyStore{need_.data()});
  for_each_team(
      "list neighbours", particles.size(),
      ListNeighbours<Selection>{select, particles.predicted(), cells, view(), entry_.data(), count_.data(),
                                store_.data(), store_.size(), need_.data(), witness, margin, ++builds});
}

void NeighbourList::build(PredictedView particles, const Grid& grid, Witness witness) {
  list(particles, grid, AllParticles{}, witness);
}

void NeighbourList::build(PredictedView particles, const Grid& grid, ActiveParticles active,
                          Witness witness) {
  list(particles, grid, active, witness);
}

void NeighbourList::build(PredictedView particles, const Grid& grid, EverySlot everyone, Witness witness) {
  list(particles, grid, everyone, witness);
}

void NeighbourList::assign(const std::vector<std::vector<int>>& lists) {
  std::vector<int> counts;
  for (const auto& list : lists) {
    counts.push_back(static_cast<int>(list.size()));
    capacity_ = std::max(capacity_, counts.back() + 1);
  }
  const std::size_t groups = (lists.size() + list_interleave - 1) / list_interleave;
  std::vector<int> entries(groups * list_interleave * static_cast<std::size_t>(capacity_));
  for (std::size_t i = 0; i < lists.size(); ++i) {
    for (std::size_t k = 0; k < lists[i].size(); ++k) {
      entries[view().place(static_cast<int>(i), static_cast<int>(k))] = lists[i][k];
    }
  }
  count_.from_host(counts);
  entry_.from_host(entries);
}

void NeighbourList::put_back(const std::vector<int>& counts, const std::vector<int>& entries) {
  const std::size_t groups = (counts.size() + list_interleave - 1) / list_interleave;
  std::vector<int> placed(groups * list_interleave * static_cast<std::size_t>(capacity_));
  std::vector<int> store;
  std::size_t from = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto length = static_cast<std::size_t>(std::max(counts[i], 0));
    if (length > entries.size() - from)
      throw base::Error("saved state", "contains neighbour lists that end early", "save the state again");
    const int slot = static_cast<int>(i);
    const bool stored = counts[i] > view().room();
    if (stored) placed[view().place(slot, 0)] = static_cast<int>(store.size());
    for (std::size_t k = 0; k < length; ++k, ++from) {
      if (stored) {
        store.push_back(entries[from]);
      } else {
        placed[view().place(slot, static_cast<int>(k))] = entries[from];
      }
    }
  }
  if (store.size() > store_.size())
    throw base::Error("saved state", "contains more neighbours than it has space for",
                      "save the state again");
  count_.from_host(counts);
  entry_.from_host(placed);
  if (!store.empty()) copy_from_host(store_.data(), store.data(), store.size() * sizeof(int));
}

std::vector<std::vector<int>> NeighbourList::lists() const {
  const auto count = count_.to_host();
  const auto entry = entry_.to_host();
  const auto store = store_.to_host();
  const Neighbours on_host{count.data(), entry.data(), store.data(), capacity_};
  std::vector<std::vector<int>> out(count.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int slot = static_cast<int>(i);
    for (int k = 0; k < count[i]; ++k) out[i].push_back(on_host(slot, k));
  }
  return out;
}

bool NeighbourList::grow() { return need_.size() > 0 && grow(need_.to_host()[0]); }

bool NeighbourList::grow(Need met) {
  bool grew = false;
  if (met.stored > store_.size() && store_.size() < most_store) {
    store_.resize(std::min<std::size_t>(most_store, 2 * met.stored));
    grew = true;
  }
  if (met.stored > count_.size() / most_stored && capacity_ < most_capacity) {
    capacity_ = std::min({most_capacity, (met.longest + 1) * 5 / 4, capacity_ * 5 / 4});
    grew = true;
  }
  if (grew) need_.zero();
  return grew;
}

}  // namespace sim::SIM_BACKEND
