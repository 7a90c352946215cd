#pragma once
/// Runs live stimuli like a session, as fast as possible, and records the time of each step.

#include <functional>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/check/rehearsal.hpp"
#include "libstudy/display/stimulus.hpp"

namespace study {

/// Longest time that measure() takes for a stimulus, s, without the time to make the stimulus: the longest
/// trial of its cells, but at least 5 s.
double longest_measuring_s(const Protocol& protocol, const MeasuredStimulus& what);

/// Measures the steps of a trial of these cells from start_frame on; prepares and renders each step as a
/// session does. Ends after the last step of the longest trial. After 5 s, also ends as soon as the
/// measurement is behind the schedules of all cells whose trials have steps left. The first 5 s do not count
/// for this, because a fluid's first steps are the fastest. refresh_hz: as for content_steps(). `each` (may
/// be empty) is called after every step.
StepTimes measure(const Protocol& protocol, const std::vector<int>& cells, Stimulus& stimulus,
                  Display& display, Clock& clock, double refresh_hz, const std::function<void()>& each);

}  // namespace study
