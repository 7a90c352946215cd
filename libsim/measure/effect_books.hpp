#pragma once
/// The totals that a scene's effects keep over a run.

#include <string>

#include "libsim/simulation.hpp"
#include "stats/base/json.hpp"

namespace measure {

/// {"foam": {...}, "heat": {...}} for the listed effects with a coefficient above 0; an empty object without
/// any. Foam: numbers of diffuse particles, and the volume of all particles emitted, m3. Heat: kelvin above
/// the effect's reference times m_*.
base::Json effect_books(const sim::Scene& scene, const sim::FrameReport& report);
/// One line per effect for readers, as `vip-bench frame` prints them.
std::string in_words(const base::Json& books);

}  // namespace measure
