#pragma once
/// Captures that CapFrameX saved as JSON, as the lines of a frame log.

#include <cstddef>
#include <string>
#include <vector>

namespace study {

/// The frames of a capture. Source: the classes SessionRun and SessionCaptureData of CapFrameX.
struct CapFrameXLog {
  /// A CSV file with a line of names, then a line for each frame, run after run. Columns: "Application", with
  /// the program and, of several runs, the run's number; then each list of Runs[].CaptureData that all runs
  /// have. null and "NaN" are "NA", false and true are 0 and 1.
  std::string csv;
  std::vector<std::size_t> frames;  ///< number of frames of each run
};

/// Reads the text of a JSON file. `file`: its name, for messages. base::Error for text that is no JSON, such
/// as a file that was cut, for JSON without Runs[].CaptureData, and for lists of different lengths.
CapFrameXLog read_capframex_json(const std::string& file, const std::string& text);

/// "run 2, frame 17" of the frame with this index, counted over all runs.
std::string place_of_frame(const CapFrameXLog& log, std::size_t index);

}  // namespace study
