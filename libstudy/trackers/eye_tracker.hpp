#pragma once
/// An eye tracker outside OpenXR: reads its samples on a thread of its own and gives them the computer's
/// time.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "libstudy/display/gaze.hpp"
#include "libstudy/trackers/tracker_link.hpp"

namespace study {

/// A sample on the computer's clock.
struct TrackedGaze {
  std::int64_t sampled_ns = 0;  ///< on CLOCK_MONOTONIC
  std::int64_t device_ns = 0;   ///< on the tracker's own clock
  std::int64_t arrived_ns = 0;  ///< when it was read, on CLOCK_MONOTONIC
  bool valid = false;
  std::array<double, 3> direction{0, 0, -1};  ///< in the head's frame, after the fixed rotation
};

/// What came from a sender since it was opened.
struct TrackerCounts {
  std::int64_t samples = 0;     ///< usable ones, valid or not
  std::int64_t unreadable = 0;  ///< lines or values that were no samples
  std::int64_t backwards = 0;   ///< samples whose time is not after that of the sample before
  std::int64_t far = 0;         ///< samples whose time is far from their arrival
  std::int64_t overflow = 0;    ///< samples that nobody took in time
};

/// A sample's time may be before its arrival by at most oldest_sample_ns and after it by at most
/// future_sample_ns. Others are refused: they are delayed too much to be followed, or their clock is wrong.
inline constexpr std::int64_t oldest_sample_ns = 1'000'000'000, future_sample_ns = 50'000'000;

/// The samples are kept from start() to stop() only, which frame the time for which the participant consents;
/// others are dropped as soon as they are read. The clock offset is measured when the tracker is opened, when
/// a lost sender is back, and after each stop(); the newest one is in force from start() on. Calls come from
/// one thread.
class EyeTracker {
 public:
  /// Opens what --gaze names and measures the first offset, which takes up to some seconds. turn_deg: fixed
  /// rotation of the rays, to the left, up, and leaning to the left. base::Error if nobody sends, or if the
  /// sender's clock cannot be measured.
  explicit EyeTracker(const std::string& gaze, const std::array<double, 3>& turn_deg = {});
  /// As above with an open link.
  EyeTracker(const std::string& gaze, std::unique_ptr<TrackerLink> link,
             const std::array<double, 3>& turn_deg);
  ~EyeTracker();
  EyeTracker(const EyeTracker&) = delete;
  EyeTracker& operator=(const EyeTracker&) = delete;

  void start();
  /// The samples since start() or the last take(), in the order of time.
  std::vector<TrackedGaze> take();
  void stop();

  std::string device() const;
  TrackerCounts counts() const;
  /// The newest offset, and all that were measured since the last call.
  TrackerClock clock() const;
  std::vector<TrackerClock> take_clocks();
  std::vector<std::string> take_news();
  /// Why no usable samples come now; empty: they come.
  std::string trouble() const;

 private:
  void measure_first();
  void work();
  void take_in(const std::vector<TrackerSample>& batch);
  void adopt_offset();
  void recover(const std::string& reason);
  void measure();
  void tell_of_refused();

  const std::string gaze_;
  const std::array<double, 3> turn_deg_;
  std::array<double, 9> turn_{};  ///< rows of the rotation
  std::unique_ptr<TrackerLink> link_;
  std::atomic<bool> stopping_ = false, measure_ = false;
  std::int64_t measured_at_ns_ = 0;  ///< when the last measurement of the offset began

  mutable std::mutex mutex_;  ///< guards the members below, except thread_
  std::string device_;
  bool listening_ = false;
  std::optional<std::int64_t> offset_ns_, newest_offset_ns_;  ///< none: not measured since the sender came
  std::int64_t last_ns_ = 0;                                  ///< time of the newest usable sample
  std::int64_t arrived_ns_ = 0;                               ///< arrival of the newest usable sample
  std::vector<TrackedGaze> samples_;
  TrackerCounts counts_, told_, at_sample_;  ///< now, when the log was told, at the newest usable sample
  TrackerClock clock_;
  std::vector<TrackerClock> clocks_;
  std::vector<std::string> news_;
  std::string gone_;  ///< why the sender is gone; empty: it is there, and its clock is known
  std::thread thread_;
};

/// The rows of the rotation by these angles: to the left about y, then up about x, then leaning to the left
/// about z of the turned frame. base::Error naming --gaze-turn for an angle that is not within [-180, 180].
std::array<double, 9> rotation_of(const std::array<double, 3>& turn_deg);

}  // namespace study
