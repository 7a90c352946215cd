#pragma once
/// Frame times from the capture (recording) of a running program, for timing profiles that replay them.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace study {

struct FrameCapture {
  std::string column;            ///< name of the column that was read; empty: the file has no names
  std::vector<double> frame_ms;  ///< in their order, rounded to microseconds; at least two
  std::int64_t left_out = 0;     ///< rows without a frame time, of frames never shown or of the first frame
  std::vector<std::string> remarks;  ///< those of the frame log (FrameLog::remarks)
};

/// Reads the frame log of one window, in any format of read_frame_logs().
///
/// column: the name of the column to read. If it is empty: intervals between frames; without them, between
/// changes of the picture. seconds: reads the first frames that fill this time; none: all frames.
///
/// base::Error as read_frame_log(), and at the file for a capture shorter than `seconds`, with fewer than two
/// frames, or with more than most_trace_frames.
FrameCapture read_capture(const std::filesystem::path& file, const std::string& column,
                          std::optional<double> seconds);

/// The line "timing = ..." of a [[factor.level]] table in a protocol (TOML) that shows these frames.
std::string timing_line(const FrameCapture& capture);
/// Duration, and mean, standard deviation and 5 % low of the frame rate, in words. 5 % low: the mean frame
/// rate of the slowest twentieth of the frames.
std::string describe_capture(const FrameCapture& capture);

}  // namespace study
