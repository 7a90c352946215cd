#pragma once
/// A nozzle that pours downwards in pulses, and the schedule of its layers.

#include <array>
#include <cstdint>
#include <vector>

namespace sim {

/// A round nozzle that pours straight down.
struct Nozzle {
  double diameter_m = 0;
  std::array<double, 3> position_m{};  ///< centre of the mouth
  double speed_m_s = 0;                ///< of the water at the mouth
  int on_frames = 0;                   ///< duration of a pulse; the first begins at frame 0
  int off_frames = 0;                  ///< pause after each pulse
  double temperature_k = 0;            ///< of the water; 0 = the reference of the effect heat
};

/// True if the nozzle would put particles where one of `others` puts its own in the same frame: their mouths
/// overlap as seen from above, and one lies no further below the other than the water moves in a frame.
bool pours_into_another(const Nozzle& nozzle, const std::vector<Nozzle>& others, double frame_dt_s);

/// A layer of the jet: `sites` particles on a Vogel spiral over the mouth, each of volume spacing^3. The
/// distance between layers is `pitch_m` = spacing^3 sites / A, with the area A of the mouth. The flow A u at
/// the speed u is therefore the same at every spacing.
struct JetLayer {
  int sites = 0;
  double pitch_m = 0;
};
JetLayer jet_layer(const Nozzle& nozzle, double spacing_m);

/// The part of a nozzle's jet that has passed the mouth, as a length and as a number of layers.
struct Poured {
  double length_m = 0;
  std::int64_t layers = 0;
};
/// Length and number of layers that a nozzle has poured before `frame` if all layers have the same spacing.
/// The result depends only on the arguments, so that a run from a checkpoint pours like the original run.
Poured poured_before(const Nozzle& nozzle, double spacing_m, int frame, double frame_dt_s);

/// The layers that pass the mouth within one frame.
struct LayersDue {
  int count = 0;
  double first_time_s = 0;  ///< from the frame's start until the first passes the mouth
  double interval_s = 0;    ///< between layers
};

/// The next layer passes the mouth when the nozzle has been open for (before.length_m + pitch / 2) / speed in
/// all pulses together. Frames are counted from 0; `frame_dt_s` > 0.
LayersDue layers_due(const Nozzle& nozzle, double spacing_m, const Poured& before, int frame,
                     double frame_dt_s);

}  // namespace sim
