#pragma once
/// Counts of what a database holds about one session. Read-only; errors as read_tasks().

#include <cstdint>
#include <filesystem>
#include <string>

namespace study {

struct SessionCounts {
  std::string participant, state;    ///< state: as SessionRow::state
  std::int64_t units = 0, done = 0;  ///< pages and trials
  std::int64_t trials = 0, answered = 0, excluded = 0;
  std::int64_t showings = 0, cut = 0, counting = 0;  ///< cut: cut short; counting: an answer about it counts
  std::int64_t pass = 0, degraded = 0, fail = 0;     ///< timing verdicts of showings
  std::int64_t answers = 0, frames = 0, notes = 0;
};
/// A missing session gives an empty participant.
SessionCounts count_session(const std::filesystem::path& database, std::int64_t session);

/// A paragraph for the experimenter.
std::string summary_of(const SessionCounts& counts);

}  // namespace study
