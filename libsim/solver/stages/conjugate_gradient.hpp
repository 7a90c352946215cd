#pragma once
/// State of the conjugate gradients between passes (libsim/solver/effects).

#include "libsim/exec/ordered_sum.hpp"

namespace sim::SIM_BACKEND {

/// Scalars of a step, on the device: the host decides nothing.
struct ConjugateStep {
  float rest;   ///< r r
  float along;  ///< step length of x along p
  float turn;   ///< factor of p in the next direction
};

/// Empty until the first solve.
struct ConjugateGradient {
  OrderedSum sum;
  Array<ConjugateStep> step;
};

/// alpha = r r / p A p, or 0 if p A p is 0.
struct TakeAlong {
  ConjugateStep* step;
  SIM_FN void operator()(float bent) const { step->along = bent > 0 ? step->rest / bent : 0; }
};
/// beta = new r r / old r r, or 0 if the old r r is 0.
struct TakeTurn {
  ConjugateStep* step;
  SIM_FN void operator()(float rest) const {
    step->turn = step->rest > 0 ? rest / step->rest : 0;
    step->rest = rest;
  }
};

}  // namespace sim::SIM_BACKEND
