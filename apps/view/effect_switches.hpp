#pragma once
/// The effects of a scene as a viewer turns them on and off. No window, no GL.

#include <string>
#include <vector>

#include "libsim/scene/effects.hpp"

namespace apps {

/// An effect that the scene lists.
struct EffectSwitch {
  sim::Effect effect;
  double most = 0;  ///< end of its coefficient's scale: four times what the scene lists
  bool on = false;
};
/// One for each that is listed, as those that run have it.
std::vector<EffectSwitch> switches_of(const std::vector<sim::Effect>& listed,
                                      const std::vector<sim::Effect>& running);
/// Those that are on, but for what needs one that is not.
std::vector<sim::Effect> turned_on(const std::vector<EffectSwitch>& switches);
/// Turns off those of coefficient 0, and those that need one that is off.
void drop_what_cannot_run(std::vector<EffectSwitch>& switches);
/// What is left of the listed without these kinds, words with commas, and without what needs them.
/// base::Error for a word that is not listed.
std::vector<sim::Effect> left_on(const std::vector<sim::Effect>& listed, const std::string& off);
/// "cohesion, air_drag", or "no effects".
std::string in_words(const std::vector<sim::Effect>& effects);

}  // namespace apps
