#include "libsim/levels/level_state.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Begin {
  const std::uint8_t* level;
  std::uint8_t* target;
  std::uint8_t* history;
  std::uint8_t* age;
  std::uint8_t* waiting;
  const Vec4* velocity;
  Vec4* drift;
  SIM_FN void operator()(int i) const {
    target[i] = level[i];
    history[i] = steady_history(level[i]);
    age[i] = 255;
    waiting[i] = 0;
    const Vec3 v = xyz(velocity[i]);
    if (drift) drift[i] = with_w(v, dot(v, v));
  }
};

}  // namespace

void LevelState::begin(NewLevelsView p) {
  counts.resize(1);
  counts.zero();
  for_each("begin levels", p.size(),
           Begin{.level = p.level(),
                 .target = p.target(),
                 .history = p.history(),
                 .age = p.age(),
                 .waiting = p.waiting(),
                 .velocity = p.velocity(),
                 .drift = p.drift()});
}

}  // namespace sim::SIM_BACKEND
