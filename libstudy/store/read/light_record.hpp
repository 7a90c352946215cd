#pragma once
/// Reads the recorded frame onsets that the log of a light sensor is compared with.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/light/light_fit.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// A played showing of a stimulus.
struct LitShowing {
  RecordedShowing shown;  ///< onsets by its recorded grade (placed_ns())
  int position = 0, attempt = 0, interval = 0;
  std::string grade;  ///< recorded grade; empty: none
};

/// A part of a session that one start of the program showed, so that its clock did not change.
struct LitStretch {
  std::int64_t session = 0, protocol = 0;  ///< row numbers
  std::string participant;
  int visit = 0;
  bool patch = false;                    ///< run with --light-patch
  bool virtual_clock = false;            ///< shown to nobody
  std::vector<LitShowing> showings;      ///< in order of time
  std::vector<std::int64_t> markers_ns;  ///< when the session's markers left the computer, same clock
};

/// The stretches of all sessions with at least one showing, or of one participant. Showings without ascending
/// onsets are left out. base::Error if no session of the database is of this participant and visit.
/// participant: empty: all. visit: 0: all.
std::vector<LitStretch> read_light_record(const StudyFile& study, const std::string& participant, int visit);

}  // namespace study
