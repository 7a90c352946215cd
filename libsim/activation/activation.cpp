#include "libsim/activation/activation.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct PlaceInSlots {
  const std::uint8_t* active;
  const int* ranks;
  int* slots;
  int* slot_of;
  const Vec4* predicted;
  Vec4* predicted_next;
  float* lambda;
  float* density;
  int n;

  SIM_FN void operator()(int i) const {
    const int slot = active[i] ? ranks[i] - 1 : n - 1 - (i - ranks[i]);
    slot_of[i] = slot;
    slots[slot] = active[i] ? i : ~i;
    if (active[i]) return;
    lambda[i] = 0;
    density[i] = 1;
    predicted_next[i] = predicted[i];
  }
};

}  // namespace

void Activation::list_active(ActiveListView p) {
  const int n = p.size();
  const auto size = static_cast<std::size_t>(n);
  slots.resize(size);
  slot_of.resize(size);
  scanner.inclusive_count(p.active(), n, ranks);
  for_each("active slots", n,
           PlaceInSlots{.active = p.active(),
                        .ranks = ranks.data(),
                        .slots = slots.data(),
                        .slot_of = slot_of.data(),
                        .predicted = p.predicted(),
                        .predicted_next = p.predicted_next(),
                        .lambda = p.lambda(),
                        .density = p.density(),
                        .n = n});
}

std::size_t Activation::bytes() const {
  return grid.bytes() + importance.bytes() + probability.bytes() + slope_x.bytes() + slope_y.bytes() +
         slope_z.bytes() + across_levels.bytes() + total.bytes() + energy_slope.bytes() + before.bytes() +
         after.bytes() + change.bytes() + ranks.bytes() + slots.bytes() + slot_of.bytes();
}

}  // namespace sim::SIM_BACKEND
