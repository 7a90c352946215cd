#pragma once
/// One loop over each particle's neighbours that computes the sums of one stage, or of two that share it. The
/// schedule decides which stages share a loop (schedule.cpp); here the terms of the loop are template
/// parameters.

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

/// A pair i, j as a term receives it.
struct NeighbourPair {
  int j;
  float x, y, z;  ///< vector from particle j to particle i, m
  float h;        ///< support of particle j, m
  /// (m_j / m_i) poly6 (h^2 - r^2)^2, with h here the pair's mean support: the gradient of W is -6 (m_i /
  /// m_j) slope (x, y, z).
  float slope;
};

/// A term that adds nothing, and the interface of all terms. `sums`: how many of the four sums it uses.
/// takes(): true if a particle of this support has sums.
/// Self: data read once for particle i. add(): adds a neighbour. finish(): called by one lane after all
/// neighbours. skip(): for particles without sums.
struct NoTerm {
  static constexpr int sums = 0;
  SIM_FN bool takes(float) const { return false; }
  struct Self {};
  SIM_FN Self self(int) const { return {}; }
  SIM_FN void add(const NeighbourPair&, Self, float&, float&, float&, float&) const {}
  SIM_FN void finish(int, Vec4, Self, float, float, float, float) const {}
  SIM_FN void skip(int) const {}
};

template <bool OneLevel, class First, class Second>
struct PairLoop {
  const Vec4* position;
  Neighbours neighbours;
  First first;
  Second second;

  struct Self {
    Vec4 at;
    PairKernel<OneLevel> pair;
    typename First::Self first;
    typename Second::Self second;
  };

  /// Adds particle j. This is a separate function, so that the loop vectorises (SIM_LANES).
  SIM_FN void add(int j, const Self& me, float& a0, float& a1, float& a2, float& a3, float& b0, float& b1,
                  float& b2, float& b3) const {
    const Vec4 other = position[j];
    const Kernel kernel = me.pair.with(other.w);
    const float dx = me.at.x - other.x;
    const float dy = me.at.y - other.y;
    const float dz = me.at.z - other.z;
    const float t = at_least(kernel.h2 - (dx * dx + dy * dy + dz * dz), 0.0f);
    const float h = OneLevel ? me.at.w : other.w;
    const NeighbourPair pair{j, dx, dy, dz, h, me.pair.mass_ratio(other.w) * kernel.poly6 * t * t};
    first.add(pair, me.first, a0, a1, a2, a3);
    second.add(pair, me.second, b0, b1, b2, b3);
  }

  /// Sums over the lanes if the term uses sum `number`.
  template <class Term, int number, class Team>
  SIM_FN static float sum(Team team, float mine) {
    if constexpr (Term::sums >= number) return team.sum(mine);
    return mine;
  }

  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const Vec4 at = position[i];
    const bool has_first = first.takes(at.w);
    const bool has_second = second.takes(at.w);
    if (!has_first) first.skip(i);
    if (!has_second) second.skip(i);
    if (!has_first && !has_second) return;
    const Self me{at, PairKernel<OneLevel>(at.w), first.self(i), second.self(i)};
    float a0 = 0;
    float a1 = 0;
    float a2 = 0;
    float a3 = 0;
    float b0 = 0;
    float b1 = 0;
    float b2 = 0;
    float b3 = 0;
    const int count = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    SIM_LANES(a0, a1, a2, a3, b0, b1, b2, b3)
    for (int k = team.rank(); k < count; k += Team::size) add(run[k], me, a0, a1, a2, a3, b0, b1, b2, b3);
    a0 = sum<First, 1>(team, a0);
    a1 = sum<First, 2>(team, a1);
    a2 = sum<First, 3>(team, a2);
    a3 = sum<First, 4>(team, a3);
    b0 = sum<Second, 1>(team, b0);
    b1 = sum<Second, 2>(team, b1);
    b2 = sum<Second, 3>(team, b2);
    b3 = sum<Second, 4>(team, b3);
    if (team.rank() > 0) return;
    if (has_first) first.finish(i, at, me.first, a0, a1, a2, a3);
    if (has_second) second.finish(i, at, me.second, b0, b1, b2, b3);
  }
};

using PairView = Reads<Column::Position, Column::Neighbours>;

template <bool OneLevel, class First, class Second>
void launch_pair_loop(const char* label, FluidState& state, PairView p, First first, Second second) {
  for_each_team(
      label, p.size(),
      PairLoop<OneLevel, First, Second>{
          .position = p.position(), .neighbours = state.neighbours.view(), .first = first, .second = second});
}
/// `label` names the pass in errors and profiles.
template <class First, class Second = NoTerm>
void run_pair_loop(const char* label, FluidState& state, PairView p, First first, Second second = {}) {
  state.one_level ? launch_pair_loop<true>(label, state, p, first, second)
                  : launch_pair_loop<false>(label, state, p, first, second);
}

}  // namespace sim::SIM_BACKEND
