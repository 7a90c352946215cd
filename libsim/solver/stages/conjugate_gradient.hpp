#pragma once
/// What conjugate gradients keep between their passes (libsim/solver/effects).

#include "libsim/exec/ordered_sum.hpp"

namespace sim::SIM_BACKEND {

/// Numbers of a step, on the device: no step is decided on the host.
struct ConjugateStep {
  float rest;   ///< r r
  float along;  ///< how far x goes along p
  float turn;   ///< how much of p the next one keeps
};

/// Empty until the first solve.
struct ConjugateGradient {
  OrderedSum sum;
  Array<ConjugateStep> step;
};

/// alpha = r r / p A p, and 0 once nothing is left.
struct TakeAlong {
  ConjugateStep* step;
  SIM_FN void operator()(float bent) const { step->along = bent > 0 ? step->rest / bent : 0; }
};
/// beta = r r now / r r before, and 0 once nothing is left.
struct TakeTurn {
  ConjugateStep* step;
  SIM_FN void operator()(float rest) const {
    step->turn = step->rest > 0 ? rest / step->rest : 0;
    step->rest = rest;
  }
};

}  // namespace sim::SIM_BACKEND
