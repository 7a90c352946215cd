/// Groups of cells, pairs of a group, and the number of its trials.
#include "libstudy/protocol/design.hpp"

#include <algorithm>
#include <set>

namespace study {

namespace {

bool same_group(const Design& design, const Cell& a, const Cell& b) {
  if (design.factors.empty())
    return a.stimulus.scene == b.stimulus.scene && a.stimulus.n_star == b.stimulus.n_star;
  for (std::size_t i = 0; i < design.factors.size(); ++i)
    if (design.factors[i].between && a.levels[i] != b.levels[i]) return false;
  return true;
}

/// Number of tracks of an adaptive procedure in one group: combinations of the levels of all factors but the
/// procedure's, without the standard.
int track_count(const Design& design, const std::vector<int>& group) {
  std::set<std::vector<int>> tracks;
  for (const int index : group) {
    const Cell& cell = design.cells[static_cast<std::size_t>(index)];
    if (design.standard && is_standard(design, cell)) continue;
    std::vector<int> levels = cell.levels;
    levels[design.procedure->factor] = 0;
    tracks.insert(levels);
  }
  return static_cast<int>(tracks.size());
}

/// True if `standard` is a standard, `cell` is none, and both have the same level of every factor that
/// Design::standard does not name.
bool is_compared_with(const Design& design, int cell, int standard) {
  const Cell &a = design.cells[static_cast<std::size_t>(cell)],
             &b = design.cells[static_cast<std::size_t>(standard)];
  if (is_standard(design, a) || !is_standard(design, b)) return false;
  for (std::size_t i = 0; i < design.factors.size(); ++i)
    if (!(*design.standard)[i] && a.levels[i] != b.levels[i]) return false;
  return true;
}

}  // namespace

bool is_standard(const Design& design, const Cell& cell) {
  for (std::size_t i = 0; i < design.factors.size(); ++i)
    if (cell.levels[i] != (*design.standard)[i].value_or(cell.levels[i])) return false;
  return true;
}

bool varies_surface(const Design& design) {
  return std::any_of(design.cells.begin(), design.cells.end(), [&](const Cell& one) {
    return one.stimulus.surface != design.cells.front().stimulus.surface;
  });
}

std::vector<std::vector<int>> cell_groups(const Design& design) {
  std::vector<std::vector<int>> out;
  for (std::size_t i = 0; i < design.cells.size(); ++i) {
    if (i == 0 || !same_group(design, design.cells[i - 1], design.cells[i])) out.emplace_back();
    out.back().push_back(static_cast<int>(i));
  }
  return out;
}

std::vector<std::pair<int, int>> pairs_of_group(const Design& design, const std::vector<int>& group) {
  std::vector<std::pair<int, int>> out;
  if (design.standard) {
    for (const int cell : group)
      for (const int other : group)
        if (is_compared_with(design, cell, other)) out.emplace_back(cell, other);
    return out;
  }
  for (std::size_t i = 0; i < group.size(); ++i)
    for (std::size_t j = i + 1; j < group.size(); ++j) out.emplace_back(group[i], group[j]);
  return out;
}

int trials_of_group(const Design& design) {
  const auto group = cell_groups(design).front();
  if (design.procedure) return track_count(design, group) * design.procedure->trials;
  const auto pairs = static_cast<int>(pairs_of_group(design, group).size());
  return design.repetitions * (design.pairs ? pairs : static_cast<int>(group.size()));
}

}  // namespace study
