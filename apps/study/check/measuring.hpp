#pragma once
/// Runs live stimuli as a session does, as fast as they come, and keeps what each step took.

#include <functional>
#include <vector>

#include "apps/study/check/rehearsal.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/display/stimulus.hpp"

namespace apps {

/// The longest that measuring it takes, s, apart from its making: as long as its longest trial, at least 5 s.
double longest_measuring_s(const study::Protocol& protocol, const MeasuredStimulus& what);

/// Goes through a trial of these cells from start_frame on: prepare and render each step, as a session does.
/// Ends at the last step that a cell shows, or earlier when after 5 s it is behind the schedule of each cell
/// that is not through: the first steps of a fluid are the cheapest. refresh_hz: as content_steps(). `each`
/// (may be empty) is called after every step.
StepTimes measure(const study::Protocol& protocol, const std::vector<int>& cells, study::Stimulus& stimulus,
                  study::Display& display, study::Clock& clock, double refresh_hz,
                  const std::function<void()>& each);

}  // namespace apps
