#pragma once
/// Several small passes in one launch. No pass may read or write data that another pass of the launch writes.

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// A pass that calls f(0) ... f(n-1); n may be 0, not negative.
template <class F>
struct Pass {
  int n;
  F f;
};

/// Two passes as one: first the indices of `first`, then those of `second`.
template <class First, class Second>
struct BothPasses {
  int first_n;
  First first;
  Second second;

  SIM_FN void operator()(int i) const {
    if (i < first_n) {
      first(i);
    } else {
      second(i - first_n);
    }
  }
};

/// Runs all passes in one launch, in any order.
template <class F>
void for_each_pass(const char* label, Pass<F> all) {
  for_each(label, all.n, all.f);
}
template <class First, class Second, class... Rest>
void for_each_pass(const char* label, Pass<First> first, Pass<Second> second, Rest... rest) {
  using Both = BothPasses<First, Second>;
  for_each_pass(label, Pass<Both>{first.n + second.n, Both{first.n, first.f, second.f}}, rest...);
}

}  // namespace sim::SIM_BACKEND
