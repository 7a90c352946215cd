#pragma once
/// Frame times from the logs of other programs, for a timing certificate of what they showed.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/pacing/pacer.hpp"

namespace study {

/// The events between which the intervals of a log were measured. Named: the user named the column, and the
/// events are not known.
enum class Intervals { Frames, DisplayChanges, Named };

/// The frame times of one window (swap chain) of one program, from one column of a log.
struct FrameLog {
  std::string source;  ///< program, process and swap chain in words; empty: the log names none
  std::string column;  ///< name of the column that was read; empty: the file has no names
  Intervals kind = Intervals::Frames;
  std::vector<double> frame_ms;  ///< in their order; at least two
  /// Rows without a frame time: frames that were never shown, and the first frame if none precedes it.
  std::int64_t left_out = 0;
  std::optional<double> animation_error_ms;  ///< mean |animation error|; none: not in the log
  std::int64_t animation_rows = 0;           ///< number of rows in that mean
  bool cut = false;  ///< true: the last line of the file does not end, and its row was left out
  /// What the log does not determine, such as a window that has too few frames; empty: nothing.
  std::vector<std::string> remarks;
};

/// Reads a CSV file of PresentMon 1 or 2, OCAT, FrameView, CapFrameX, FRAPS (frametimes), MangoHud or
/// Unreal's CSV profiler, a JSON file of CapFrameX, a table with a column of frame times in ms, or one column
/// of numbers without a name.
///
/// column: the name of the column to read. If it is empty: the intervals between frames (MsBetweenPresents,
/// FrameTime, or the differences of "Time (ms)") and between changes of the picture (MsBetweenDisplayChange
/// or DisplayedTime), as far as the file has them. The result has one element for each window and column, in
/// the order of their first rows; a column without frame times of a window is left out.
///
/// MangoHud's older logs hold microseconds, which the column of frame rates shows. Windows with fewer than
/// two frame times are left out, with a remark, as is a last row whose line does not end: a program that was
/// stopped may have cut its last number.
///
/// base::Error at file:line for a file that is no such table, for a blank line inside the table, and for a
/// frame time outside shortest_trace_ms to longest_trace_ms. base::Error at the file for a log that holds
/// samples or mean rates instead of each frame, and if no window has two frame times. base::Error at
/// file:line if the display column has an interval for a frame that was never shown.
std::vector<FrameLog> read_frame_logs(const std::filesystem::path& file, const std::string& column);

/// The log of a file that holds one window: of its columns the first of this kind, else the first.
/// base::Error as read_frame_logs(), and at the file if it holds several windows.
FrameLog read_frame_log(const std::filesystem::path& file, const std::string& column, Intervals preferred);

/// The frames of a log as a trial whose frames came when they were due: a log has no schedule.
PlayedTrial played_of_log(const FrameLog& log);
/// B (DisplayFeedback) for changes of the picture, else D (CpuSubmit).
TimingGrade grade_of_log(const FrameLog& log);

}  // namespace study
