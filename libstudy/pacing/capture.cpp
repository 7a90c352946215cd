#include "libstudy/pacing/capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "libstudy/pacing/frame_log.hpp"
#include "libstudy/pacing/profile.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"
#include "stats/fps_window.hpp"

namespace study {

namespace {

constexpr double slow_share = 0.05;  // share of the frames, the slowest: their mean rate is the "5 % low"

/// Keeps the first frames that together last at least `seconds`. base::Error if all frames last less.
void cut(FrameCapture& capture, double seconds, const std::string& file) {
  double time_s = 0;
  std::size_t count = 0;
  while (count < capture.frame_ms.size() && time_s < seconds) time_s += 1e-3 * capture.frame_ms[count++];
  if (time_s < seconds)
    throw base::Error(file, fmt::format("lasts {:.3f} s, and --seconds asks for {:g}", time_s, seconds),
                      "lower --seconds; a trace is repeated to the length of the stimulus");
  capture.frame_ms.resize(count);
}

}  // namespace

FrameCapture read_capture(const std::filesystem::path& file, const std::string& column,
                          std::optional<double> seconds) {
  FrameLog log = read_frame_log(file, column, Intervals::Frames);
  FrameCapture out{log.column, std::move(log.frame_ms), log.left_out, std::move(log.remarks)};
  for (double& ms : out.frame_ms) ms = std::round(1e3 * ms) / 1e3;
  if (seconds) cut(out, *seconds, file.string());
  if (out.frame_ms.size() < 2 || out.frame_ms.size() > most_trace_frames)
    throw base::Error(
        file.string(),
        "holds " + std::to_string(out.frame_ms.size()) + " frames" +
            (seconds ? " in the time of --seconds" : ""),
        "give a capture of 2 to " + std::to_string(most_trace_frames) + " frames, or change --seconds");
  return out;
}

std::string timing_line(const FrameCapture& capture) {
  std::string out = "timing = {profile = \"trace\", frame_ms = [";
  for (std::size_t i = 0; i < capture.frame_ms.size(); ++i)
    out += (i > 0 ? ", " : "") + base::shortest(capture.frame_ms[i]);
  return out + "]}";
}

std::string describe_capture(const FrameCapture& capture) {
  std::vector<double> intervals_s;
  for (const double ms : capture.frame_ms) intervals_s.push_back(1e-3 * ms);
  const stats::FpsMoments moments = stats::fps_moments(intervals_s);
  const double duration_s = std::accumulate(intervals_s.begin(), intervals_s.end(), 0.0);
  std::sort(intervals_s.begin(), intervals_s.end(), std::greater<>());
  const auto slow = static_cast<std::size_t>(std::ceil(slow_share * static_cast<double>(intervals_s.size())));
  const double slow_s =
      std::accumulate(intervals_s.begin(), intervals_s.begin() + static_cast<std::ptrdiff_t>(slow), 0.0);
  return fmt::format("{} frames in {:.3f} s, mean {:.2f}, SD {:.2f}, 5 % low {:.2f} frames/s",
                     intervals_s.size(), duration_s, moments.mean, moments.sd,
                     static_cast<double>(slow) / slow_s);
}

}  // namespace study
