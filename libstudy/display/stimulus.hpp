#pragma once
/// What a trial shows (Stimulus) and where (Display). libstudy uses fluids and GL only through these two
/// interfaces.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/display/canvas.hpp"

namespace study {

/// How often a fluid's safety rules acted while it computed one frame; the schema says what each counts.
struct FrameGuards {
  std::int64_t speed_limited = 0, coincident_pairs = 0, not_finite = 0, neighbours_dropped = 0;
  std::int64_t wall_projected = 0, nozzle_waited = 0, saliency_not_finite = 0, gaze_lost = 0;
};

/// Parameters of temporal acceleration in one frame, for a fluid that skips particles.
struct FrameTolerance {
  std::optional<double> tau_fps;            ///< empty: no frame time was known yet
  double beta = 1;                          ///< lowest probability of being solved, [0, 1]
  double active_fraction = 1;               ///< share of particles that were solved, [0, 1]
  std::optional<double> mu_fps, delta_fps;  ///< mean and standard deviation behind tau; empty: tau was given
};

/// Facts about a frame from its producer, stored in every frame record. Empty if not measured.
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
  /// Names scene, method, n_*, back end and bake hash, for the record.
  virtual std::string description() const = 0;
  /// Content steps after which the process ends or repeats; 0 = unlimited.
  virtual std::int64_t length() const = 0;
  /// Rewinds to content step `start_step`.
  virtual void start(std::int64_t start_step) = 0;
  /// Makes content step `step` (>= the last one asked for) ready to draw.
  virtual FrameFacts prepare(std::int64_t step) = 0;
  /// Draws the prepared step. base::Error if it cannot be drawn for two eyes.
  virtual void draw(const Canvas& canvas) = 0;
};

/// When a frame was submitted and displayed, on the session's clock, in nanoseconds; -1 = not known.
struct PresentTimes {
  std::int64_t submitted_ns = -1;
  std::int64_t gpu_done_ns = -1;
  std::int64_t predicted_display_ns = -1;
  std::int64_t actual_display_ns = -1;
};

/// Grade of the evidence for onset times. Compositor: the compositor predicted the display time.
enum class TimingGrade : char { Photodiode = 'A', DisplayFeedback = 'B', Compositor = 'C', CpuSubmit = 'D' };

/// The time that is compared with a frame's scheduled time: the predicted display time under grade C if there
/// is a prediction, else the submission.
inline std::int64_t placed_ns(const PresentTimes& times, TimingGrade grade) {
  const bool predicted = grade == TimingGrade::Compositor && times.predicted_display_ns >= 0;
  return predicted ? times.predicted_display_ns : times.submitted_ns;
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
  /// The measured refresh rate: a screen of 60 Hz may run at 59.95 Hz. Holds are counted in its periods.
  virtual double measured_hz() const { return refresh_hz(); }
  /// The first instant from earliest_ns on at which a schedule may begin, on the session's clock. A screen
  /// with a fixed refresh returns the middle between two refreshes, so that jitter moves no frame into
  /// another period.
  virtual std::int64_t first_onset(std::int64_t earliest_ns) const { return earliest_ns; }
  /// Draws the stimulus off-screen so that present() is short. May do nothing.
  virtual void render(Stimulus& stimulus) = 0;
  /// Shows the rendered frame at scheduled_ns or as soon after it as possible; returns once it was submitted.
  /// Waits on the session's clock.
  virtual PresentTimes present(std::int64_t scheduled_ns, Clock& clock) = 0;
  /// Keeps the presented frame on until until_ns; returns then or earlier. For displays that must redraw it
  /// meanwhile.
  virtual void hold(std::int64_t /*until_ns*/, Clock&) {}
  /// Ends a presentation, complete or cut: its frame is no longer shown.
  virtual void clear() {}
};

}  // namespace study
