#pragma once
/// A nozzle that pours downwards in pulses, and the timetable of its layers. Pure functions of the frame
/// number: a run that starts from a checkpoint pours as the run that made it.

#include <array>
#include <cstdint>

namespace sim {

/// A round mouth that pours straight down.
struct Nozzle {
  double diameter_m = 0;
  std::array<double, 3> position_m{};  ///< centre of the mouth
  double speed_m_s = 0;                ///< of the water at the mouth
  int on_frames = 0;                   ///< a pulse lasts so long, from frame 0
  int off_frames = 0;                  ///< and then rests
};

/// A layer of the jet: a Vogel disc of `sites` particles, each of volume spacing^3. Layers follow each other
/// by `pitch_m` = spacing^3 sites / A, so that the flow A u is the same at every spacing.
struct JetLayer {
  int sites = 0;
  double pitch_m = 0;
};
JetLayer jet_layer(const Nozzle& nozzle, double spacing_m);

/// Layers whose turn comes within one frame.
struct LayersDue {
  std::int64_t first = 0;  ///< number of the first of them since frame 0; it turns the layer
  int count = 0;
  double first_time_s = 0;  ///< from the frame's start to the moment when the first passes the mouth
  double interval_s = 0;    ///< from layer to layer
};

/// Layer k passes the mouth when the nozzle has been open for (k + 1/2) pitch / speed; pulses share one
/// count. Frames are counted from 0; `frame_dt_s` > 0.
LayersDue layers_due(const Nozzle& nozzle, double spacing_m, int frame, double frame_dt_s);

}  // namespace sim
