#pragma once
/// Sickness data of all sessions: pages of the Simulator Sickness Questionnaire (SSQ) and answers on the Fast
/// Motion Sickness scale (FMS). Read-only.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/study_file.hpp"
#include "stats/analysis/ssq.hpp"

namespace study {

/// One showing of the SSQ's items.
struct SsqPage {
  int position = 0;  ///< of its unit in the session, from 0
  std::string block;
  bool before = false;  ///< before the session's first trial
  std::string answered_utc;
  stats::SsqAnswers answers;
};

/// One answer on the FMS. Answers at excluded or repeated trials count as well: they say how the person felt,
/// whatever was shown.
struct FmsAnswer {
  int position = 0;  ///< as in SsqPage
  std::string block;
  std::optional<int> trial;  ///< position among the trials; empty: a page
  std::string answered_utc;
  double minutes = 0;  ///< wall-clock time since the session's first answer of any kind
  int score = 0;       ///< 0 to 20
};

struct SicknessSession {
  std::int64_t id = 0;
  std::string protocol_name, protocol_sha256;
  std::string participant;  ///< code
  int visit = 1;
  std::string observer;  ///< simulated observer that answered; empty = a person
  bool test_data = false;
  std::vector<SsqPage> ssq;    ///< in the order of answering, like fms
  std::vector<FmsAnswer> fms;  ///< without unanswered ones

  /// The last page before the first trial, and the last one after it; nullptr if there is none.
  const SsqPage* ssq_before() const;
  const SsqPage* ssq_after() const;
};

/// Every session with an answer to SSQ or FMS, by protocol, participant and visit. base::Error for an answer
/// outside its scale.
std::vector<SicknessSession> read_sickness(sqlite::Connection& database);
/// base::Error as read_tasks().
std::vector<SicknessSession> read_sickness(const StudyFile& study);

}  // namespace study
