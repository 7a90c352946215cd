#pragma once
/// Turns a scene's effects on and off in a viewer. The code needs no window and no GL.

#include <string>
#include <vector>

#include "libsim/scene/effects.hpp"

namespace apps {

/// A switch and a slider for an effect that the scene lists.
struct EffectSwitch {
  sim::Effect effect;
  double most = 0;  ///< upper end of the coefficient's slider: four times the scene's value
  bool on = false;
};
/// One switch per effect of `listed`; on if the effect runs with a coefficient above 0. The coefficient is
/// that in `running`, otherwise that in `listed`.
std::vector<EffectSwitch> switches_of(const std::vector<sim::Effect>& listed,
                                      const std::vector<sim::Effect>& running);
/// The effects that are on with a coefficient above 0, without effects that need an effect that is off.
std::vector<sim::Effect> turned_on(const std::vector<EffectSwitch>& switches);
/// Turns off each effect with coefficient 0, and each effect that needs an effect that is off.
void drop_what_cannot_run(std::vector<EffectSwitch>& switches);
/// The listed effects without the kinds in `off` (words with commas) and without effects that need one of
/// these kinds. base::Error for a word that is no listed effect.
std::vector<sim::Effect> left_on(const std::vector<sim::Effect>& listed, const std::string& off);
/// Names of the effects, such as "cohesion, air_drag"; "no effects" if there are none.
std::string in_words(const std::vector<sim::Effect>& effects);

}  // namespace apps
