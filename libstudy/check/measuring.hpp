#pragma once
/// Runs live stimuli like a session, as fast as possible, and records the time of each step.

#include <functional>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/check/rehearsal.hpp"
#include "libstudy/display/stimulus.hpp"

namespace study {

/// Longest measuring time without making the stimulus, s: its longest trial, at least 5 s.
double longest_measuring_s(const Protocol& protocol, const MeasuredStimulus& what);

/// Runs a trial of these cells from start_frame on: prepares and renders each step like a session. Ends at
/// the last step of any cell, or after 5 s as soon as it is behind the schedule of every unfinished cell: the
/// first steps of a fluid are the cheapest. refresh_hz: as content_steps(). `each` (may be empty) is called
/// after every step.
StepTimes measure(const Protocol& protocol, const std::vector<int>& cells, Stimulus& stimulus,
                  Display& display, Clock& clock, double refresh_hz, const std::function<void()>& each);

}  // namespace study
