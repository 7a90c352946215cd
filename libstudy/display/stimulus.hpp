#pragma once
/// Interfaces for the content of a trial (Stimulus) and the device that shows it (Display). A session uses
/// fluids and OpenGL only through these two interfaces.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/display/canvas.hpp"

namespace study {

/// How often each safety rule of the fluid solver acted in one frame: particle-substeps with limited speed,
/// neighbour pairs at zero distance, particles with NaN or infinity, neighbours that found no room in a list,
/// particle-substeps pushed back inside a wall, layers of water that a nozzle left out, particles without a
/// finite saliency, and eyes without a valid gaze.
struct FrameGuards {
  std::int64_t speed_limited = 0, coincident_pairs = 0, not_finite = 0, neighbours_dropped = 0;
  std::int64_t wall_projected = 0, nozzle_waited = 0, saliency_not_finite = 0, gaze_lost = 0;
};

/// Parameters of temporal acceleration in one frame, for a fluid that skips particles.
struct FrameTolerance {
  /// Tolerance tau = mu - a exp(b delta) (Eq. 11 of the paper), frames/s, with a and b of stats::PtpeModel;
  /// none: no frame time was known yet.
  std::optional<double> tau_fps;
  double beta = 1;             ///< lowest probability that a particle is solved, [0, 1]
  double active_fraction = 1;  ///< share of particles that were solved, [0, 1]
  /// Mean mu and standard deviation delta of the frame rate, frames/s; none: tau is fixed, or no frame time
  /// was known yet.
  std::optional<double> mu_fps, delta_fps;
};

/// Facts about a frame, from the stimulus that made the frame. Every frame record stores them. An empty
/// member was not measured.
struct FrameFacts {
  double simulation_time_s = 0;
  std::vector<std::int64_t> particles_by_level;  ///< finest first
  std::optional<FrameTolerance> tolerance;
  std::optional<FrameGuards> guards;
};

/// A process that advances in content steps. Not thread-safe.
class Stimulus {
 public:
  virtual ~Stimulus() = default;
  /// Text for the session's record: scene, method, n_* (number of particles if all were at the coarsest
  /// level), back end and bake hash.
  virtual std::string description() const = 0;
  /// Number of content steps after which the process ends or repeats; 0: unlimited.
  virtual std::int64_t length() const = 0;
  /// Rewinds to content step `start_step`.
  virtual void start(std::int64_t start_step) = 0;
  /// Computes content step `step` so that draw() can draw it; `step` >= the last prepared step.
  virtual FrameFacts prepare(std::int64_t step) = 0;
  /// Draws the prepared step. base::Error if the canvas has two eyes and the stimulus cannot draw for two
  /// eyes.
  virtual void draw(const Canvas& canvas) = 0;
};

/// When a frame was submitted and displayed, on the session's clock, in nanoseconds; -1 = not known.
struct PresentTimes {
  std::int64_t submitted_ns = -1;
  std::int64_t gpu_done_ns = -1;
  std::int64_t predicted_display_ns = -1;
  std::int64_t actual_display_ns = -1;
};

/// Grade of the evidence for onset times, from best to worst. Compositor: the display time is a prediction of
/// the compositor. CpuSubmit: only the time of submission is known.
enum class TimingGrade : char { Photodiode = 'A', DisplayFeedback = 'B', Compositor = 'C', CpuSubmit = 'D' };

/// The time that is compared with a frame's scheduled time. Under grade C this is the predicted display time,
/// if there is a prediction. Otherwise it is the submission time.
inline std::int64_t placed_ns(const PresentTimes& times, TimingGrade grade) {
  if (grade == TimingGrade::Compositor && times.predicted_display_ns >= 0) return times.predicted_display_ns;
  return times.submitted_ns;
}

class Clock;

/// Shows frames. One instance per session.
class Display {
 public:
  virtual ~Display() = default;
  virtual std::string description() const = 0;
  virtual TimingGrade grade() const = 0;
  /// Fixed refresh rate in Hz; 0 if frames are shown as they arrive.
  virtual double refresh_hz() const = 0;
  /// The measured refresh rate, Hz: a screen of 60 Hz may run at 59.95 Hz. A hold of k periods lasts
  /// k / measured_hz() seconds.
  virtual double measured_hz() const { return refresh_hz(); }
  /// False while the refresh rate is not known, or not the one that the protocol requires: no trial may
  /// begin.
  virtual bool keeps_rate() const { return true; }
  /// The first instant from earliest_ns on at which a schedule may begin, on the session's clock. A window on
  /// a screen with a fixed refresh returns the middle between two refreshes: small delays then move no frame
  /// into another refresh period. A headset returns the display time of a slot.
  virtual std::int64_t first_onset(std::int64_t earliest_ns) const { return earliest_ns; }
  /// Draws the stimulus off-screen in advance, so that present() is short. A display may do nothing here.
  virtual void render(Stimulus& stimulus) = 0;
  /// Shows the rendered frame at scheduled_ns or as soon after as possible. Waits on the session's clock and
  /// returns once the frame was submitted.
  virtual PresentTimes present(std::int64_t scheduled_ns, Clock& clock) = 0;
  /// Keeps the presented frame on the display until until_ns, for displays that must redraw it. Returns at
  /// until_ns or earlier.
  virtual void hold(std::int64_t /*until_ns*/, Clock&) {}
  /// Ends the showing of a stimulus, complete or cut: removes its last frame from the display.
  virtual void clear() {}
};

}  // namespace study
