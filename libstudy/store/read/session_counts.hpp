#pragma once
/// Numbers of units, trials, showings, answers and other rows of one session. Does not change the database.
/// base::Error if the database cannot be opened (open_study()).

#include <cstdint>
#include <filesystem>
#include <string>

namespace study {

struct SessionCounts {
  std::string participant, state;    ///< participant code; "open", "done" or how the session ended early
  std::int64_t units = 0, done = 0;  ///< pages and trials: all, and those that are done
  std::int64_t trials = 0, answered = 0, excluded = 0;
  std::int64_t showings = 0, cut = 0, counting = 0;  ///< all; cut short; those with an answer that counts
  std::int64_t pass = 0, degraded = 0, fail = 0;     ///< numbers of showings with each timing verdict
  std::int64_t answers = 0, frames = 0, notes = 0;
};
/// The counts of a session; `participant` is empty if the session does not exist.
SessionCounts count_session(const std::filesystem::path& database, std::int64_t session);

/// The counts as a paragraph of text for the experimenter.
std::string summary_of(const SessionCounts& counts);

}  // namespace study
