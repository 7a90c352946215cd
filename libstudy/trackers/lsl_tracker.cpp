/// Gaze from a stream of the Lab Streaming Layer.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libstudy/base/clock.hpp"
#include "libstudy/markers/lsl_library.hpp"
#include "libstudy/trackers/tracker_link.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

/// The functions of liblsl that are used, as its interface for C declares them (lsl_streaminfo and lsl_inlet
/// are pointers).
struct LslInletFunctions {
  std::int32_t (*resolve_byprop)(void** found, std::uint32_t most, const char* property, const char* value,
                                 std::int32_t least, double timeout_s);
  void (*destroy_streaminfo)(void* info);
  std::int32_t (*get_channel_count)(void* info);
  std::int32_t (*get_channel_format)(void* info);
  const char* (*get_hostname)(void* info);
  void* (*create_inlet)(void* info, std::int32_t buffered_s, std::int32_t chunk, std::int32_t recover);
  void (*destroy_inlet)(void* inlet);
  void (*open_stream)(void* inlet, double timeout_s, std::int32_t* error);
  double (*pull_sample_d)(void* inlet, double* values, std::int32_t count, double timeout_s,
                          std::int32_t* error);
  double (*time_correction_ex)(void* inlet, double* remote_s, double* uncertainty_s, double timeout_s,
                               std::int32_t* error);
  double (*local_clock)();
};

constexpr std::int32_t text_format = 3;  // cft_string
constexpr std::int32_t lsl_timeout = -1, lsl_lost = -2;
constexpr double find_within_s = 3, twin_within_s = 0.3, open_within_s = 3, again_within_s = 0.5;
constexpr std::int32_t inlet_buffer_s = 2;
constexpr int most_pulled = 1000;
/// Nanoseconds of twice this time fit into 64 bits, s.
constexpr double most_lsl_s = 4e9;
constexpr const char* channels_mend =
    "send 3 numbers, x right, y up, z back, or 4 with the validity, 0 or 1; docs/headset.md has the format";

class LslTracker final : public TrackerLink {
 public:
  LslTracker(std::string place, std::string name) : place_(std::move(place)), name_(std::move(name)) {
    void* library = open_lsl_library(place_);
    const auto find = [&](const char* function, auto& pointer) {
      find_lsl_function(library, place_, function, pointer);
    };
    find("lsl_resolve_byprop", lsl_.resolve_byprop);
    find("lsl_destroy_streaminfo", lsl_.destroy_streaminfo);
    find("lsl_get_channel_count", lsl_.get_channel_count);
    find("lsl_get_channel_format", lsl_.get_channel_format);
    find("lsl_get_hostname", lsl_.get_hostname);
    find("lsl_create_inlet", lsl_.create_inlet);
    find("lsl_destroy_inlet", lsl_.destroy_inlet);
    find("lsl_open_stream", lsl_.open_stream);
    find("lsl_pull_sample_d", lsl_.pull_sample_d);
    find("lsl_time_correction_ex", lsl_.time_correction_ex);
    find("lsl_local_clock", lsl_.local_clock);
    if (const std::string reason = open(find_within_s); !reason.empty())
      throw base::Error(place_, reason, mend_);
  }
  ~LslTracker() override { close(); }
  LslTracker(const LslTracker&) = delete;
  LslTracker& operator=(const LslTracker&) = delete;

  std::string device() const override { return device_; }

  std::string read(std::vector<TrackerSample>& out, std::int64_t most_ns) override {
    if (!inlet_) return "its stream is not open";
    double wait_s = 1e-9 * static_cast<double>(most_ns);
    for (int pulled = 0; pulled < most_pulled; ++pulled, wait_s = 0) {
      std::array<double, 4> values{0, 0, 0, 1};
      std::int32_t error = 0;
      const double time_s = lsl_.pull_sample_d(inlet_, values.data(), channels_, wait_s, &error);
      if (error != 0 && error != lsl_timeout) {
        close();
        return error == lsl_lost ? "its stream has ended" : "liblsl returned error " + std::to_string(error);
      }
      if (error == lsl_timeout || time_s == 0) return "";
      take(time_s, values, out);
    }
    return "";
  }

  /// liblsl measures all the time: after the first call, the newest offset is read at once.
  void measure() override {
    if (!inlet_) return;
    double remote_s = 0, uncertainty_s = 0;
    std::int32_t error = 0;
    const double correction_s = lsl_.time_correction_ex(inlet_, &remote_s, &uncertainty_s,
                                                        known_ ? again_within_s : open_within_s, &error);
    if (error != 0 || !std::isfinite(correction_s) || std::abs(correction_s) > most_lsl_s) return;
    known_ = true;
    const double trip_s = std::isfinite(uncertainty_s) ? std::clamp(uncertainty_s, 0.0, 1e6) : 1e6;
    const RealClock clock;
    // The narrowest of some readings of both clocks; liblsl's own is CLOCK_MONOTONIC on Linux as a rule.
    std::int64_t width_ns = 0, lsl_behind_ns = 0;
    for (int i = 0; i < 5; ++i) {
      const std::int64_t before_ns = clock.now_ns();
      const double lsl_s = lsl_.local_clock();
      const std::int64_t after_ns = clock.now_ns();
      if (i > 0 && after_ns - before_ns >= width_ns) continue;
      width_ns = after_ns - before_ns;
      lsl_behind_ns = before_ns + width_ns / 2 - std::llround(1e9 * lsl_s);
    }
    measured_ = ClockOffset{clock.now_ns(), std::llround(1e9 * correction_s) + lsl_behind_ns,
                            std::llround(1e9 * trip_s) + width_ns};
  }

  std::optional<ClockOffset> take_offset() override { return std::exchange(measured_, {}); }
  std::string reach() override { return open(again_within_s); }
  std::int64_t take_unreadable() override { return std::exchange(unreadable_, 0); }

 private:
  void close() {
    if (inlet_) lsl_.destroy_inlet(inlet_);
    inlet_ = nullptr;
  }

  /// Finds the stream and opens it. Returns why it failed, or an empty text; mend_ is the remedy.
  std::string open(double within_s) {
    close();
    std::array<void*, 2> found{};
    std::int32_t count = lsl_.resolve_byprop(found.data(), 1, "name", name_.c_str(), 1, within_s);
    mend_ = "start the program that sends it, and check that the network lets LSL pass";
    if (count < 1 || !found[0]) return "no stream of this name was found";
    lsl_.destroy_streaminfo(found[0]);
    found = {};
    count = std::min(2, lsl_.resolve_byprop(found.data(), 2, "name", name_.c_str(), 2, twin_within_s));
    const std::string reason = count == 1 ? open_found(found[0]) : "";
    for (int i = 0; i < count; ++i) lsl_.destroy_streaminfo(found[static_cast<std::size_t>(i)]);
    if (count > 1) {
      mend_ = "give each stream a name of its own, or stop one";
      return "two streams have this name";
    }
    return count == 1 ? reason : "the stream vanished again";
  }

  std::string open_found(void* info) {
    channels_ = lsl_.get_channel_count(info);
    mend_ = channels_mend;
    if (channels_ != 3 && channels_ != 4)
      return "the stream has " + std::to_string(channels_) + " channels, and gaze has 3 or 4";
    if (lsl_.get_channel_format(info) == text_format) return "the stream holds text, and gaze is numbers";
    const char* host = lsl_.get_hostname(info);
    const std::string from = host && base::is_plain_line(host) ? base::shortened(host, 60) : "";
    device_ = base::shortened(name_, 60) + (from.empty() ? "" : " on " + from);
    mend_ = "restart the program that sends it";
    inlet_ = lsl_.create_inlet(info, inlet_buffer_s, 0, 1);
    if (!inlet_) return "liblsl does not open the stream";
    std::int32_t error = 0;
    lsl_.open_stream(inlet_, open_within_s, &error);
    if (error == 0) return "";
    close();
    return "liblsl does not open the stream (error " + std::to_string(error) + ")";
  }

  void take(double time_s, const std::array<double, 4>& values, std::vector<TrackerSample>& out) {
    TrackerSample sample;
    sample.direction = {values[0], values[1], values[2]};
    const bool numbers = std::isfinite(values[0]) && std::isfinite(values[1]) && std::isfinite(values[2]);
    const bool flagged = values[3] == 0 || !numbers;  // NaN is what LSL's eye trackers send of lost eyes
    sample.valid = !flagged && values[3] == 1 && normalise(sample.direction);
    if (!std::isfinite(time_s) || std::abs(time_s) > most_lsl_s || (!sample.valid && !flagged)) {
      ++unreadable_;
      return;
    }
    if (!sample.valid) sample.direction = TrackerSample().direction;
    sample.device_ns = std::llround(1e9 * time_s);
    out.push_back(sample);
  }

  std::string place_, name_, device_, mend_;
  LslInletFunctions lsl_{};
  void* inlet_ = nullptr;
  std::int32_t channels_ = 4;
  bool known_ = false;  ///< an offset was measured; the first one takes longest
  std::int64_t unreadable_ = 0;
  std::optional<ClockOffset> measured_;
};

}  // namespace

std::unique_ptr<TrackerLink> open_lsl_tracker(const std::string& place, const std::string& rest) {
  return std::make_unique<LslTracker>(place, rest);
}

}  // namespace study
