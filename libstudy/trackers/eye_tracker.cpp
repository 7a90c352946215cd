#include "libstudy/trackers/eye_tracker.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "libstudy/base/clock.hpp"
#include "libstudy/base/no_signals.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr std::int64_t read_ns = 10'000'000, first_offset_ns = 3'000'000'000, silent_ns = 90'000'000;
constexpr std::chrono::milliseconds try_again_every{500}, look_every{20};
/// Samples that wait for take(): some seconds of the fastest trackers.
constexpr std::size_t most_waiting = 8192;

std::int64_t monotonic_ns() { return RealClock().now_ns(); }

}  // namespace

std::array<double, 9> rotation_of(const std::array<double, 3>& turn_deg) {
  for (const double angle : turn_deg) {
    if (!(std::abs(angle) <= 180))
      throw base::Error("--gaze-turn", "has an angle beyond 180 degrees",
                        "write the angles to the left, up and leaning to the left, such as 0,-2.5,0");
  }
  constexpr double degree = std::numbers::pi / 180;
  const double cy = std::cos(turn_deg[0] * degree), sy = std::sin(turn_deg[0] * degree);
  const double cx = std::cos(turn_deg[1] * degree), sx = std::sin(turn_deg[1] * degree);
  const double cz = std::cos(turn_deg[2] * degree), sz = std::sin(turn_deg[2] * degree);
  // R = Ry Rx Rz.
  return {cy * cz + sy * sx * sz,  -cy * sz + sy * sx * cz, sy * cx, cx * sz, cx * cz, -sx,
          -sy * cz + cy * sx * sz, sy * sz + cy * sx * cz,  cy * cx};
}

EyeTracker::EyeTracker(const std::string& gaze, const std::array<double, 3>& turn_deg)
    : EyeTracker(gaze, open_tracker_link(gaze), turn_deg) {}

EyeTracker::EyeTracker(const std::string& gaze, std::unique_ptr<TrackerLink> link,
                       const std::array<double, 3>& turn_deg)
    : gaze_(gaze), turn_deg_(turn_deg), turn_(rotation_of(turn_deg)), link_(std::move(link)) {
  device_ = link_->device();
  measure_first();
  const NoSignals in_thread;  // a thread inherits the mask
  thread_ = std::thread([this] { work(); });
}

EyeTracker::~EyeTracker() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void EyeTracker::measure_first() {
  const std::string place = "gaze from " + gaze_;
  link_->measure();
  const std::int64_t until_ns = monotonic_ns() + first_offset_ns;
  std::vector<TrackerSample> before_consent;
  while (!newest_offset_ns_) {
    if (const std::string reason = link_->read(before_consent, read_ns); !reason.empty())
      throw base::Error(place, "its sender is gone: " + reason, "start the sender again");
    before_consent.clear();
    adopt_offset();
    if (!newest_offset_ns_ && monotonic_ns() > until_ns)
      throw base::Error(place, "the offset of its sender's clock could not be measured within 3 s",
                        gaze_.starts_with("tcp:")
                            ? "let the sender answer each line 'p NUMBER' at once with 'p NUMBER SECONDS'; "
                              "docs/headset.md has an example of a sender"
                            : "let the network pass the packets (UDP) by which LSL measures it");
  }
}

void EyeTracker::work() {
  std::vector<TrackerSample> batch;
  while (!stopping_) {
    batch.clear();
    const std::string gone = link_->read(batch, read_ns);
    take_in(batch);
    const bool unknown = !newest_offset_ns_ && monotonic_ns() - measured_at_ns_ > first_offset_ns;
    if (measure_.exchange(false) || unknown) measure();
    adopt_offset();
    if (!gone.empty()) recover(gone);
  }
}

void EyeTracker::take_in(const std::vector<TrackerSample>& batch) {
  const std::int64_t now_ns = monotonic_ns();
  const std::int64_t unreadable = link_->take_unreadable();
  const std::lock_guard lock(mutex_);
  counts_.unreadable += unreadable;
  for (const TrackerSample& sample : batch) {
    if (!offset_ns_) continue;  // the clock of a sender that is back is not known yet
    const std::int64_t sampled_ns = sample.device_ns + *offset_ns_;
    if (sampled_ns > now_ns + future_sample_ns || sampled_ns < now_ns - oldest_sample_ns) {
      ++counts_.far;
      continue;
    }
    if (sampled_ns <= last_ns_) {
      ++counts_.backwards;
      continue;
    }
    last_ns_ = sampled_ns;
    arrived_ns_ = now_ns;
    ++counts_.samples;
    at_sample_ = counts_;
    if (!listening_) continue;
    if (samples_.size() >= most_waiting) {
      counts_.overflow += static_cast<std::int64_t>(samples_.size() / 2);
      samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(samples_.size() / 2));
    }
    TrackedGaze gaze{sampled_ns, sample.device_ns, now_ns, sample.valid, {}};
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < 3; ++k) gaze.direction[row] += turn_[3 * row + k] * sample.direction[k];
    }
    samples_.push_back(gaze);
  }
}

void EyeTracker::adopt_offset() {
  const auto offset = link_->take_offset();
  if (!offset) return;
  const std::lock_guard lock(mutex_);
  device_ = link_->device();
  clock_ = {gaze_, device_, turn_deg_, offset->clock_ns, offset->offset_ns, offset->round_trip_ns};
  clocks_.push_back(clock_);
  newest_offset_ns_ = offset->offset_ns;
  if (!gone_.empty()) news_.push_back("the sender of gaze from " + gaze_ + " is back");
  gone_.clear();
  // Within a trial the offset stays, so that no step stands in its times.
  if (!offset_ns_ || !listening_) offset_ns_ = newest_offset_ns_;
}

void EyeTracker::recover(const std::string& reason) {
  {
    const std::lock_guard lock(mutex_);
    const bool was_there = gone_.empty();
    gone_ = "the sender of gaze from " + gaze_ + " is gone: " + reason;
    if (was_there) news_.push_back(gone_);
    offset_ns_.reset();
    newest_offset_ns_.reset();
  }
  auto next = std::chrono::steady_clock::now() + try_again_every;
  while (!stopping_) {
    std::this_thread::sleep_for(look_every);
    if (std::chrono::steady_clock::now() < next) continue;
    if (link_->reach().empty()) return measure();
    next = std::chrono::steady_clock::now() + try_again_every;
  }
}

void EyeTracker::measure() {
  measured_at_ns_ = monotonic_ns();
  link_->measure();
}

void EyeTracker::tell_of_refused() {
  const auto tell = [&](std::int64_t now, std::int64_t before, const char* what) {
    if (now > before) news_.push_back(fmt::format("gaze from {}: {} {}", gaze_, now - before, what));
  };
  tell(counts_.unreadable, told_.unreadable, "lines or values could not be read");
  tell(counts_.backwards, told_.backwards, "samples were not after the sample before");
  tell(counts_.far, told_.far, "samples had times far from their arrival");
  tell(counts_.overflow, told_.overflow, "samples came faster than they were taken");
  told_ = counts_;
}

void EyeTracker::start() {
  const std::lock_guard lock(mutex_);
  if (newest_offset_ns_) offset_ns_ = newest_offset_ns_;
  listening_ = true;
}

std::vector<TrackedGaze> EyeTracker::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(samples_, {});
}

void EyeTracker::stop() {
  {
    const std::lock_guard lock(mutex_);
    listening_ = false;
    samples_.clear();
    tell_of_refused();
  }
  measure_ = true;
}

std::string EyeTracker::device() const {
  const std::lock_guard lock(mutex_);
  return device_;
}

TrackerCounts EyeTracker::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

TrackerClock EyeTracker::clock() const {
  const std::lock_guard lock(mutex_);
  return clock_;
}

std::vector<TrackerClock> EyeTracker::take_clocks() {
  const std::lock_guard lock(mutex_);
  return std::exchange(clocks_, {});
}

std::vector<std::string> EyeTracker::take_news() {
  const std::lock_guard lock(mutex_);
  return std::exchange(news_, {});
}

std::string EyeTracker::trouble() const {
  const std::lock_guard lock(mutex_);
  if (!gone_.empty()) return gone_;
  if (monotonic_ns() - arrived_ns_ < silent_ns) return "";
  const std::string place = "the sender of gaze from " + gaze_;
  if (!offset_ns_) return place + " does not answer the pings for its clock";
  if (counts_.far > at_sample_.far) return place + " gives times far from those of arrival";
  if (counts_.backwards > at_sample_.backwards) return place + " gives times that do not go forward";
  if (counts_.unreadable > at_sample_.unreadable) return place + " sends lines that are no samples";
  return place + " sends no samples";
}

}  // namespace study
