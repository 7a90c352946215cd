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
};

/// Reads a CSV file of PresentMon or CapFrameX, a table with a column of frame times in ms, or one column of
/// numbers without a name. Fields are separated by commas, semicolons or tabs. Leading lines that begin with
/// "//" or "#" are comments.
///
/// column: the name of the column to read, in upper or lower case. If it is empty: the only column; of
/// several columns, MsBetweenPresents, FrameTime or MsBetweenDisplayChange, whichever comes first in this
/// list. seconds: reads the first frames that fill this time; none: all frames.
///
/// Zeros and "NA" are left out in the first row, which may have no frame before it, and in columns with
/// "display" in their names, where they mark frames that were never shown. base::Error at file:line for a
/// file that is no such table, for any other value outside shortest_trace_ms to longest_trace_ms, and for
/// rows of a second process or swap chain. base::Error at the file for a capture shorter than `seconds`, with
/// fewer than two frames, or with more than most_trace_frames.
FrameCapture read_capture(const std::filesystem::path& file, const std::string& column,
                          std::optional<double> seconds);

/// The line "timing = ..." of a [[factor.level]] table in a protocol (TOML) that shows these frames.
std::string timing_line(const FrameCapture& capture);
/// Duration, and mean, standard deviation and 5 % low of the frame rate, in words. 5 % low: the mean frame
/// rate of the slowest twentieth of the frames.
std::string describe_capture(const FrameCapture& capture);

}  // namespace study
