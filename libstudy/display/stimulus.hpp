#pragma once
/// What a trial shows and where it is shown. libstudy knows fluids and GL only through these two interfaces.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/display/canvas.hpp"

namespace study {

/// How often the rules of a fluid stepped in while it computed one frame; the schema says what each counts.
struct FrameGuards {
  std::int64_t speed_limited = 0, coincident_pairs = 0, not_finite = 0, neighbours_dropped = 0;
  std::int64_t wall_projected = 0, nozzle_waited = 0, saliency_not_finite = 0, gaze_lost = 0;
};

/// What a fluid that leaves particles out went by in one frame.
struct FrameTolerance {
  std::optional<double> tau_fps;            ///< empty: no frame's time was known yet
  double beta = 1;                          ///< lowest probability of being solved, [0, 1]
  double active_fraction = 1;               ///< share of particles that were solved, [0, 1]
  std::optional<double> mu_fps, delta_fps;  ///< mean and standard deviation behind tau; empty: tau was given
};

/// What a frame of the stimulus consisted of, as its producer had it; kept in every frame record. What nobody
/// measured is empty.
struct FrameFacts {
  double simulation_time_s = 0;
  std::vector<std::int64_t> particles_by_level;  ///< finest first
  std::optional<FrameTolerance> tolerance;
  std::optional<FrameGuards> guards;
};

/// A process that elapses in content steps. Not thread-safe.
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
  /// Draws the prepared step. base::Error when it cannot be seen with two eyes.
  virtual void draw(const Canvas& canvas) = 0;
};

/// When a frame was handed over and seen, on the session's clock, in nanoseconds; -1 = not known.
struct PresentTimes {
  std::int64_t submitted_ns = -1;
  std::int64_t gpu_done_ns = -1;
  std::int64_t predicted_display_ns = -1;
  std::int64_t actual_display_ns = -1;
};

/// How good the evidence for onset times is. Compositor: it predicted when it would show what it took.
enum class TimingGrade : char { Photodiode = 'A', DisplayFeedback = 'B', Compositor = 'C', CpuSubmit = 'D' };

/// What is held against a frame's scheduled time: the predicted time where a compositor shows it in periods
/// of its own (C), the submission otherwise and where nothing was predicted.
inline std::int64_t placed_ns(const PresentTimes& times, TimingGrade grade) {
  const bool predicted = grade == TimingGrade::Compositor && times.predicted_display_ns >= 0;
  return predicted ? times.predicted_display_ns : times.submitted_ns;
}

class Clock;

/// Where frames go. One instance a session.
class Display {
 public:
  virtual ~Display() = default;
  virtual std::string description() const = 0;
  virtual TimingGrade grade() const = 0;
  /// Fixed refresh rate in Hz, or 0 when frames are shown as they come.
  virtual double refresh_hz() const = 0;
  /// The same as measured: a screen of 60 Hz may take 59.95 pictures a second. Holds are counted in its
  /// periods.
  virtual double measured_hz() const { return refresh_hz(); }
  /// The first instant from earliest_ns on at which a schedule may begin, on the session's clock. A screen
  /// with a beat of its own answers with the middle between two beats, where no frame slips over an edge.
  virtual std::int64_t first_onset(std::int64_t earliest_ns) const { return earliest_ns; }
  /// Draws the stimulus off-screen so that present() is short. May do nothing.
  virtual void render(Stimulus& stimulus) = 0;
  /// Shows what was rendered at scheduled_ns, or as soon after it as it can; returns when it was handed over.
  /// Waits on the session's clock.
  virtual PresentTimes present(std::int64_t scheduled_ns, Clock& clock) = 0;
  /// What was presented stays on until until_ns; returns then or before. For displays that draw it again and
  /// again meanwhile.
  virtual void hold(std::int64_t /*until_ns*/, Clock&) {}
  /// A presentation is over, or was cut: nothing of it is shown any more.
  virtual void clear() {}
};

}  // namespace study
