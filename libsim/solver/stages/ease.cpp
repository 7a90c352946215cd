#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Computes the column Ease: the smallest share of its density constraint that a particle enforces, by the
/// age of the youngest particle within its support (LevelRules::ease). Neighbour lists are indexed by slots
/// (particles/selection.hpp). Unsolved particles get 1.
template <class Selection>
struct Ease {
  Selection select;
  const Vec4* predicted;
  const std::uint8_t* age;
  Neighbours neighbours;
  float* ease;
  LevelRules rules;
  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) {
        ease[~i] = 1;
        return;
      }
    }
    int youngest = age[i];
    const Vec4 self = predicted[i];
    const int size = neighbours.size(slot);
    const NeighbourRun run = neighbours.run(slot);
    for (int k = team.rank(); k < size; k += Team::size) {
      const int j = run[k];
      if (age[j] >= LevelRules::ease_frames || age[j] >= youngest) continue;
      const Vec4 other = predicted[j];
      const Vec3 offset = xyz(self) - xyz(other);
      const float h = 0.5f * (self.w + other.w);
      if (dot(offset, offset) < h * h) youngest = age[j];
    }
    youngest = team.min(youngest);
    if (team.rank() == 0) ease[i] = youngest < LevelRules::ease_frames ? rules.ease[youngest] : 1;
  }
};

using EaseColumns =
    ColumnView<columns(Column::Predicted, Column::Age, Column::Neighbours), columns(Column::Ease)>;

template <class Selection>
void launch(FluidState& state, EaseColumns p, Selection select) {
  for_each_team("ease", p.size(),
                Ease<Selection>{.select = select,
                                .predicted = p.predicted(),
                                .age = p.age(),
                                .neighbours = state.neighbours.view(),
                                .ease = p.ease(),
                                .rules = state.levels.rules});
}

void run_ease(FluidState& state, EaseColumns p) {
  state.all_active ? launch(state, p, AllParticles{}) : launch(state, p, state.active());
}

}  // namespace

Stage ease_stage() {
  return stage_of<run_ease>({.name = "ease",
                             .source = "blending of the constraint, after Orthmann and Kolb 2012",
                             .phase = Phase::Substep,
                             .called_for = if_levels});
}

}  // namespace sim::SIM_BACKEND
