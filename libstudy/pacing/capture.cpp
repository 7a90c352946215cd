#include "libstudy/pacing/capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "libstudy/pacing/capture_table.hpp"
#include "libstudy/pacing/profile.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"
#include "stats/fps_window.hpp"

namespace study {

namespace {

constexpr double slow_share = 0.05;  // share of the frames, the slowest: their mean rate is the "5 % low"

class CaptureReader {
 public:
  CaptureReader(const std::filesystem::path& file, const std::string& column) : table_(file) {
    column_ = column.empty() ? usual_column() : table_.chosen(column);
    out_.column = table_.names()[column_];
    for (const char* name : {"ProcessID", "SwapChainAddress"})
      if (const auto place = table_.place_of(name)) sources_[*place] = "";
  }

  FrameCapture read() {
    std::vector<std::string> fields;
    for (bool first = true; table_.next(fields); first = false) {
      check_source(fields, first);
      if (const auto ms = table_.frame_time(fields[column_], first || is_displayed(out_.column)))
        out_.frame_ms.push_back(std::round(1e3 * *ms) / 1e3);
      else
        ++out_.left_out;
    }
    return std::move(out_);
  }

 private:
  std::size_t usual_column() const {
    if (table_.names().size() == 1) return 0;
    for (const char* name : {"MsBetweenPresents", "FrameTime", "MsBetweenDisplayChange"})
      if (const auto place = table_.place_of(name)) return *place;
    table_.fail("has no column MsBetweenPresents, FrameTime or MsBetweenDisplayChange",
                "name the column with the frame times by --column; the first column of this file is " +
                    base::shortened(table_.names().front()));
  }

  /// Refuses a row of another process or swap chain than that of the rows before.
  void check_source(const std::vector<std::string>& fields, bool first) {
    for (auto& [place, source] : sources_) {
      if (first) source = fields[place];
      if (source != fields[place])
        table_.fail("is of " + table_.names()[place] + " " + base::shortened(fields[place], 40) +
                        ", and the rows before of " + base::shortened(source, 40),
                    "keep the rows of one program and one window in the file");
    }
  }

  CaptureTable table_;
  std::size_t column_ = 0;
  /// By index of a column that names the process or the swap chain: the value that all rows must have.
  std::map<std::size_t, std::string> sources_;
  FrameCapture out_;
};

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
  FrameCapture out = CaptureReader(file, column).read();
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
