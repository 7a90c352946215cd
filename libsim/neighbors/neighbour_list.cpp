#include "libsim/neighbors/neighbour_list.hpp"

#include <algorithm>

namespace sim::SIM_BACKEND {

namespace {

/// The runs of particles that can hold neighbours: nine rows of three cells,
struct OneLevelRows {
  const IndexRange* rows;
  template <class Visit>
  SIM_FN void operator()(int cell, Vec4, float, Visit visit) const {
    for (int row = 0; row < Grid::rows_per_cell; ++row) {
      const IndexRange range = rows[cell * Grid::rows_per_cell + row];
      visit(range.begin, range.end);
    }
  }
};

/// or those of every level, without the lines of cells beyond the particle's own reach.
struct MixedRows {
  LevelRowsView rows;
  template <class Visit>
  SIM_FN void operator()(int cell, Vec4 self, float margin, Visit visit) const {
    for (int level = 0; level < LevelSupports::most; ++level) {
      const LevelBox box = rows.box(cell, level);
      const float reach = 0.5f * (margin * self.w + box.edge);
      for (int row = 0; row < box.rows; ++row) {
        const LevelRow run = rows(cell, level, row);
        if (box.misses(run, self, reach)) continue;
        visit(run.begin, run.begin + run.size());
      }
    }
  }
};

template <class Rows, class Selection>
struct ListNeighbours {
  Selection select;
  const Vec4* predicted;
  const int* cell_of;
  Rows rows;
  Neighbours list;
  int* entry;
  int* count;
  int* longest;
  std::uint64_t* dropped;
  float margin;

  /// Takes the near ones of a run.
  template <class Team>
  struct Take {
    const ListNeighbours& task;
    Team team;
    int slot, i;
    Vec4 self;
    int& found;
    SIM_FN void operator()(int begin, int end) const {
      for (int first = begin; first < end; first += Team::size) {
        const int j = first + team.rank();
        const Vec4 other = task.predicted[j < end ? j : begin];
        const Vec3 offset = xyz(self) - xyz(other);
        const float radius = task.margin * 0.5f * (self.w + other.w);
        const bool near = dot(offset, offset) < radius * radius && j != i && j < end;
        int all;
        const int place = found + team.before(near, all);
        task.append(slot, place, j, near);
        found += all;
      }
    }
  };

  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) return;
    }
    int found = 0;
    const Vec4 self = predicted[i];
    rows(cell_of[i], self, margin, Take<Team>{*this, team, slot, i, self, found});
    if (team.rank() > 0) return;
    // The last slot only takes what is not kept.
    const int kept = list.capacity - 1;
    if (found > kept) {
      atomic_add(dropped, static_cast<std::uint64_t>(found - kept));
      atomic_max(longest, found);
    }
    count[slot] = found < kept ? found : kept;
  }

  SIM_FN void append(int slot, int place, int j, bool near) const {
#ifdef SIM_CUDA
    if (near && place < list.capacity) entry[list.place(slot, place)] = j;
#else
    // Stored in any case and kept by the count: a branch here is mispredicted every third time.
    entry[list.place(slot, place < list.capacity ? place : list.capacity - 1)] = j;
    (void)near;
#endif
  }
};

}  // namespace

template <class Rows, class Selection>
void NeighbourList::list(PredictedView particles, const Grid& grid, Rows rows, Selection select,
                         std::uint64_t* dropped) {
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
  if (longest_.size() == 0) {
    longest_.resize(1);
    longest_.zero();
  }
  for_each_team(
      "list neighbours", particles.size(),
      ListNeighbours<Rows, Selection>{select, particles.predicted(), grid.cell_of_particle(), rows, view(),
                                      entry_.data(), count_.data(), longest_.data(), dropped, margin});
}

void NeighbourList::build(PredictedView particles, const Grid& grid, std::uint64_t* dropped) {
  list(particles, grid, OneLevelRows{grid.rows()}, AllParticles{}, dropped);
}

void NeighbourList::build(PredictedView particles, const Grid& grid, ActiveParticles active,
                          std::uint64_t* dropped) {
  list(particles, grid, OneLevelRows{grid.rows()}, active, dropped);
}

void NeighbourList::build_mixed(PredictedView particles, const Grid& grid, std::uint64_t* dropped) {
  capacity_ = std::max(capacity_, mixed_capacity);
  list(particles, grid, MixedRows{grid.level_rows()}, AllParticles{}, dropped);
}

void NeighbourList::build_mixed(PredictedView particles, const Grid& grid, ActiveParticles active,
                                std::uint64_t* dropped) {
  capacity_ = std::max(capacity_, mixed_capacity);
  list(particles, grid, MixedRows{grid.level_rows()}, active, dropped);
}

void NeighbourList::build_mixed(PredictedView particles, const Grid& grid, EverySlot everyone,
                                std::uint64_t* dropped) {
  capacity_ = std::max(capacity_, mixed_capacity);
  list(particles, grid, MixedRows{grid.level_rows()}, everyone, dropped);
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

bool NeighbourList::grow() { return longest_.size() > 0 && grow(longest_.to_host()[0]); }

bool NeighbourList::grow(int longest) {
  if (longest < capacity_ || capacity_ >= most_capacity) return false;
  capacity_ = std::min(most_capacity, (longest + 1) * 5 / 4);
  longest_.zero();
  return true;
}

}  // namespace sim::SIM_BACKEND
