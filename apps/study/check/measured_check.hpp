#pragma once
/// Whether this machine shows what a protocol asks for when methods run live.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/fps_window.hpp"

namespace apps {

/// One stimulus as this machine ran it, frame by frame, with nothing to wait for.
struct MeasuredStimulus {
  study::StimulusSpec what;
  bool temporal = false;  ///< of a method with temporal acceleration
  std::vector<double> frame_s;
};

struct MeasureOptions {
  std::string backend = "auto";
  int frames = 60;     ///< of each stimulus
  int warm_up = 10;    ///< before them
  double most_s = 20;  ///< of each stimulus; fewer frames then
  int width_px = 1280, height_px = 720;
};

/// The different stimuli of a protocol in the order of its cells.
std::vector<study::StimulusSpec> stimuli_of(const study::Protocol& protocol);

/// Runs each of them: look, solve, draw, as a session does. base::Error: no OpenGL 4.5, a scene, method or
/// n_* that is not there.
std::vector<MeasuredStimulus> measure_stimuli(const study::Protocol& protocol, const MeasureOptions& options);

/// What follows for one stimulus.
struct MeasuredVerdict {
  study::StimulusSpec what;
  stats::FpsMoments fps;  ///< with the display's refresh as the highest rate
  double p95_ms = 0;      ///< of a frame
  double tau_min = 0;     ///< least tau over 30 frames, frames/s (Eq. 11)
  bool too_slow = false;  ///< the mean rate that is asked for is not reached
  std::string words;      ///< what is wrong; empty: nothing
};

struct MeasuredReport {
  std::vector<MeasuredVerdict> stimuli;
  bool too_slow = false;  ///< one of them at least
  std::string collapse;   ///< why `native` would compare equal stimuli; empty: it would not
};

/// refresh_hz > 0. Under a schedule a stimulus is too slow when its mean time exceeds the mean interval;
/// under TimingSource::Native when its rate stays below fps_min. The conditions collapse under Native when
/// the methods of every group all reach the refresh, or when no method with temporal acceleration ever has
/// tau below zero.
MeasuredReport judge_measured(const study::Protocol& protocol, const std::vector<MeasuredStimulus>& measured,
                              double refresh_hz);

}  // namespace apps
