#pragma once
/// Sessions that another program recorded, as vip-study import stores them. A time, a duration or a frame
/// that the source does not hold stays empty in the database.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/pacing/frame_log.hpp"

namespace study {

struct ImportedAnswer {
  std::string question;      ///< id of the question in the protocol
  std::optional<int> score;  ///< none: shown, but not answered
  std::optional<double> response_time_s;
};

/// Mean and standard deviation of the frame rate that was shown, as the source states them, frames/s.
struct StatedMoments {
  std::optional<double> mean, mean_arithmetic, sd;
};

/// One stimulus as it was shown.
struct ImportedShowing {
  int cell = 0;                       ///< index into Design::cells
  std::optional<std::int64_t> at_ns;  ///< onset on the source's clock
  StatedMoments stated;               ///< used only without `frames`
  std::optional<FrameLog> frames;     ///< none: no frame was recorded
  std::string frames_sha256;          ///< SHA-256 of the frame log; empty without one
};

struct ImportedTrial {
  std::vector<ImportedShowing> showings;  ///< one; of a pair two, in their order
  std::optional<std::string> utc;         ///< time of the answer
  std::vector<ImportedAnswer> answers;

  std::vector<int> cells() const {
    std::vector<int> out;
    for (const ImportedShowing& one : showings) out.push_back(one.cell);
    return out;
  }
};

/// One visit of one person, with the trials in the order in which they were shown.
struct ImportedSession {
  std::string participant;
  int visit = 1;
  std::optional<std::string> observer;  ///< simulated observer; none: a person
  bool test_data = false;
  std::optional<std::string> started_utc;
  bool complete = true;       ///< false: the session lacks trials of the protocol
  std::string source_sha256;  ///< SHA-256 of the file with the session's answers
  /// The same of the person's first visit in the import: with the code, it identifies the person.
  std::string first_source_sha256;
  std::vector<ImportedTrial> trials;
};

/// What a mapping says of all sessions of an import.
struct ImportTerms {
  std::string tool;            ///< the program that recorded the sessions
  bool sharing = false;        ///< true: the data may stand in public exports
  std::string incomplete;      ///< state of a session without all trials: "stopped" or "dropped out"
  std::string options;         ///< JSON for the column run.options, with the mapping's text
  std::string mapping_sha256;  ///< SHA-256 of the mapping's text
};

}  // namespace study
