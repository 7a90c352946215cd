#pragma once
/// Reads the real frame times of the trials of a protocol from the record of each frame. Does not change the
/// database.

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/study_file.hpp"

namespace study {

/// The times for which the frames of a showing stayed on, in their order.
struct FrameTimes {
  std::vector<double> intervals_s;  ///< empty if why_not is not
  /// Mean absolute difference between the steps of the simulated time and the intervals, ms; none: not
  /// recorded, because content followed frames, was imported, or is of an earlier version.
  std::optional<double> animation_error_ms;
  std::string why_not;  ///< why there are no frame times; empty: there are
};

/// The first stimulus of each trial that was played, by TaskSession::uid and TaskTrial::position. The showing
/// is that of TaskTrial::first, and the intervals are realised_intervals() of its frames, by the grade of its
/// evidence, without the last frame if its end is not recorded (imported trials). There are no frame times if
/// the record lacks a frame or its time, or if onsets do not ascend.
/// base::Error as read_tasks().
std::map<std::pair<std::string, int>, FrameTimes> read_frame_times(const StudyFile& file,
                                                                   const std::string& protocol_sha256);

}  // namespace study
