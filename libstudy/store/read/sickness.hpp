#pragma once
/// Reads the sickness data of all sessions: answers to the Simulator Sickness Questionnaire (SSQ) and on the
/// Fast Motion Sickness scale (FMS). Does not change the database.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/study_file.hpp"
#include "stats/analysis/ssq.hpp"

namespace study {

/// One answered page of the SSQ.
struct SsqPage {
  int position = 0;  ///< 0-based position of the page among the session's units
  std::string block;
  bool before = false;  ///< true: the page comes before the session's first trial
  std::string answered_utc;
  stats::SsqAnswers answers;
};

/// One answer on the FMS. Answers after excluded or repeated trials are included too, because they report the
/// person's state whatever the trial showed.
struct FmsAnswer {
  int position = 0;  ///< 0-based position of the page or trial among the session's units
  std::string block;
  std::optional<int> trial;  ///< position among the session's trials; none: answered on a page
  std::string answered_utc;
  double minutes = 0;  ///< wall-clock time since the session's first answer to any question
  int score = 0;       ///< 0 to 20
};

struct SicknessSession {
  std::int64_t id = 0;
  std::string protocol_name, protocol_sha256;
  std::string participant;  ///< participant code
  int visit = 1;
  std::string observer;  ///< simulated observer that answered; empty = a person
  bool test_data = false;
  std::vector<SsqPage> ssq;    ///< SSQ pages in the order of answering
  std::vector<FmsAnswer> fms;  ///< FMS answers in the order of answering, without questions left empty

  /// The last SSQ page before the first trial (ssq_before), or the last page if it comes after the first
  /// trial (ssq_after); nullptr if there is none.
  const SsqPage* ssq_before() const;
  const SsqPage* ssq_after() const;
};

/// Every session with an answer to the SSQ, also an empty one, or a score on the FMS; by protocol,
/// participant and visit. base::Error for an answer outside its scale or to an unknown SSQ item.
std::vector<SicknessSession> read_sickness(sqlite::Connection& database);
/// Opens the database for reading; base::Error also if it cannot be opened (open_study()).
std::vector<SicknessSession> read_sickness(const StudyFile& study);

}  // namespace study
