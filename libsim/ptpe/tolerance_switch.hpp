#pragma once
/// Switches temporal acceleration (a frame solves only part of the particles) on and off, and sets its
/// strength (paper sections 4.1 and 4.3, Eq. 11, Algorithm 3).

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "stats/fps_window.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace sim {

/// Reads an option's text: "live" gives none (tau from the measured frame times), "fixed:X" gives X in
/// frames/s, a finite number; others are a base::Error.
std::optional<double> parse_tau(std::string_view text);

/// Mean and standard deviation of a frame rate, frames/s.
struct FrameRate {
  double mean = 0, sd = 0;
  bool operator==(const FrameRate&) const = default;
};

/// Reads "MEAN,SD" in frames/s, such as "16.9,3.2", with MEAN > 0 and SD >= 0; others are a base::Error.
FrameRate parse_frame_rate(std::string_view text);

/// Switches temporal acceleration by the tolerance tau = mu - a exp(b delta), with the mean mu and standard
/// deviation delta of the frame rate over the last 30 frames: on below 0, off above +1 frames/s. Two
/// thresholds are used so that noise does not switch back and forth. A given tau (tests, benches), or the tau
/// of a given frame rate (a study's schedule), replaces the measured tau, with the same thresholds.
class ToleranceSwitch {
 public:
  static constexpr std::size_t window_frames = 30;
  static constexpr double off_above = 1;  ///< tau above which acceleration switches off, frames/s

  /// At most one of fixed_tau and fixed_rate may be given; base::Error otherwise, or if tau is not finite.
  explicit ToleranceSwitch(const stats::PtpeModel& model = {}, std::optional<double> fixed_tau = {},
                           std::optional<FrameRate> fixed_rate = {});

  /// Adds the duration of a whole frame, ms. A value that is not positive and finite is ignored and counted
  /// (left_out()); with a fixed tau the call changes nothing. on() does not change before window_frames
  /// durations are known, because delta cannot be estimated from few frames.
  void frame_time(double ms);

  /// tau = mu - a exp(b delta), frames/s; none before the first frame time is known.
  std::optional<double> tau() const { return tau_; }
  /// mu and delta from which tau was computed; none if tau was given, or is unknown.
  std::optional<FrameRate> rate() const { return rate_; }
  bool on() const { return on_; }
  /// The lowest probability that a particle is solved: beta = exp(2 b tau) while on, with tau clamped to at
  /// most 0; 1 while off, or if b < 0.
  double beta() const;
  /// True if beta is 1 in every frame, whatever the frame times.
  bool stays_off() const { return fixed_ && beta() >= 1; }
  std::uint64_t left_out() const { return left_out_; }
  /// Saves or restores the state that lasts beyond a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    std::vector<double> known(window_.intervals_s().begin(), window_.intervals_s().end());
    archive(known, on_, tau_, rate_, left_out_);
    if constexpr (Archive::reads) {
      window_ = stats::FpsWindow(window_frames);
      for (const double interval_s : known) window_.push(interval_s);
    }
  }

 private:
  void set(double tau);

  stats::PtpeModel model_;
  stats::FpsWindow window_{window_frames};
  bool fixed_ = false;
  bool on_ = false;
  std::optional<double> tau_;
  std::optional<FrameRate> rate_;
  std::uint64_t left_out_ = 0;
};

}  // namespace sim
