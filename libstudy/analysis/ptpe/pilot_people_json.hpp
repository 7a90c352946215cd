#pragma once
/// Reports how a pilot's participants used the rating scale, as JSON and in sentences.

#include <string>
#include <vector>

#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "stats/base/json.hpp"

namespace study {

/// The entry "raters": reverse coders (participants who rate higher frame rates lower), drift of the scores
/// over the session, and lapses to the lowest score, each with its test, the plan's rule and a text. It
/// identifies no participant, since a withdrawal cannot erase data from a file that was already written.
base::Json raters_json(const PilotFit& fit);
/// Codes of the reverse coders with their slopes. They are printed on the console and never written to a
/// file.
std::vector<std::string> reverse_coders(const PilotFit& fit);
/// A flag for each of reverse coding, drift and lapses that the tests found, with the plan's rule for it.
std::vector<FitFlag> rater_flags(const PilotFit& fit);

}  // namespace study
