#pragma once
/// Computes and draws the steps of a stimulus as a session without bakes does, but as fast as possible, and
/// records the time of each step.

#include <functional>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/check/rehearsal.hpp"
#include "libstudy/display/stimulus.hpp"

namespace study {

/// Longest time that measure() takes for a stimulus, s, without the time to make and start the stimulus: the
/// duration of the longest trial of its cells, but at least 5 s. The last step may end later.
double longest_measuring_s(const Protocol& protocol, const MeasuredStimulus& what);

/// Measures the times of content steps from start_frame on. Prepares and renders each step as a session does.
/// Ends after the last step of the longest trial of `cells`. After 5 s, it also ends once it is behind the
/// schedules of all cells whose trials have steps left. A cell without a frame rate counts as behind once its
/// duration is over. Being behind does not count in the first 5 s, so that more is measured than the first
/// steps of a fluid, which are the fastest. refresh_hz: refresh rate of the display, Hz (0: none), by
/// which content_steps() counts the steps of a cell without a frame rate. `each` (may be empty) is called
/// after every step.
StepTimes measure(const Protocol& protocol, const std::vector<int>& cells, Stimulus& stimulus,
                  Display& display, Clock& clock, double refresh_hz, const std::function<void()>& each);

}  // namespace study
