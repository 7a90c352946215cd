#pragma once
/// What a scene's effects keep books of, after a run.

#include <string>

#include "libsim/simulation.hpp"
#include "stats/base/json.hpp"

namespace apps {

/// {"foam": {...}, "heat": {...}} of those that the scene lists; an empty object without. Foam: numbers of
/// diffuse particles, and the volume of all that the water has made, m3. Heat: kelvin above the effect's
/// reference times m_*.
base::Json effect_books(const sim::Scene& scene, const sim::FrameReport& report);
/// A line each for people, as `vip-bench frame` prints them.
std::string in_words(const base::Json& books);

}  // namespace apps
