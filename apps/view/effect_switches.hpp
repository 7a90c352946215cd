#pragma once
/// Turns a scene's effects on and off in a viewer. No window, no GL.

#include <string>
#include <vector>

#include "libsim/scene/effects.hpp"

namespace apps {

/// An effect that the scene lists.
struct EffectSwitch {
  sim::Effect effect;
  double most = 0;  ///< upper end of the coefficient's slider: four times the scene's value
  bool on = false;
};
/// One switch per listed effect, set as in `running`.
std::vector<EffectSwitch> switches_of(const std::vector<sim::Effect>& listed,
                                      const std::vector<sim::Effect>& running);
/// The effects that are on, except those that need one that is off.
std::vector<sim::Effect> turned_on(const std::vector<EffectSwitch>& switches);
/// Turns off effects with coefficient 0, and those that need one that is off.
void drop_what_cannot_run(std::vector<EffectSwitch>& switches);
/// The listed effects without these kinds, given as words with commas, and without those that need them.
/// base::Error for a word that is not listed.
std::vector<sim::Effect> left_on(const std::vector<sim::Effect>& listed, const std::string& off);
/// "cohesion, air_drag", or "no effects".
std::string in_words(const std::vector<sim::Effect>& effects);

}  // namespace apps
