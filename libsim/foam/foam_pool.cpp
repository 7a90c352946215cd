#include "libsim/foam/foam_pool.hpp"

namespace sim::SIM_BACKEND {

void FoamPool::begin(int most, int water) {
  const auto size = static_cast<std::size_t>(most);
  place.resize(size);
  velocity.resize(size);
  place.zero();
  velocity.zero();
  ledger.resize(1);
  ledger.zero();
  free.resize(size);
  free_of.resize(size);
  for (auto* each : {&births, &sums}) each->reserve(static_cast<std::size_t>(water));
  approach.reserve(static_cast<std::size_t>(water));
  frame = 0;
}

}  // namespace sim::SIM_BACKEND
