#pragma once
/// How sick people felt: the pages of the Simulator Sickness Questionnaire (SSQ) and the answers on the Fast
/// Motion Sickness scale (FMS), of all sessions. Read-only: nothing in the database is changed.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"
#include "libstudy/store/study_file.hpp"
#include "stats/analysis/ssq.hpp"

namespace study {

/// One showing of the SSQ's items.
struct SsqPage {
  int position = 0;  ///< of its page or trial among all that the session goes through, from 0
  std::string block;
  bool before = false;  ///< before the session's first trial
  std::string answered_utc;
  stats::SsqAnswers answers;
};

/// One answer on the FMS. Those about trials that are excluded or set aside count as well: they tell how the
/// person felt, whatever was shown.
struct FmsAnswer {
  int position = 0;  ///< as in SsqPage
  std::string block;
  std::optional<int> trial;  ///< its position among the trials; empty: a page
  std::string answered_utc;
  double minutes = 0;  ///< since the session's first answer of any kind, of the clock on the wall
  int score = 0;       ///< 0 to 20
};

struct SicknessSession {
  std::int64_t id = 0;
  std::string protocol_name, protocol_sha256;
  std::string participant;  ///< code
  int visit = 1;
  std::string observer;  ///< simulated observer that answered; empty = a person
  bool test_data = false;
  std::vector<SsqPage> ssq;    ///< in the order of answering, as all here
  std::vector<FmsAnswer> fms;  ///< those left out are absent

  /// Answered last before the first trial, and last of all after it; nullptr: there is none.
  const SsqPage* ssq_before() const;
  const SsqPage* ssq_after() const;
};

/// Every session with an answer to either, by protocol, participant and visit. base::Error for an answer
/// outside its scale.
std::vector<SicknessSession> read_sickness(sqlite::Connection& database);
/// base::Error as read_tasks().
std::vector<SicknessSession> read_sickness(const StudyFile& study);

}  // namespace study
