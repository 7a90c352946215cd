#pragma once
/// Counts of what a database holds. Read-only; errors as read_tasks().

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/pacing/schedule.hpp"
#include "libstudy/protocol/design.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// A dataset: all data under one protocol hash.
struct ProtocolRow {
  std::int64_t id = 0;
  std::string name, version, sha256;
  std::string text;  ///< the protocol file
  std::optional<double> trial_seconds;
  bool test_data = false;
  std::int64_t sessions = 0, trials = 0, answered = 0;
};

struct SessionRow {
  std::int64_t protocol_id = 0;
  std::string participant;
  int visit = 1;
  std::string observer;  ///< empty = a person
  std::string clock;     ///< "real" or "virtual"
  bool test_data = false;
  std::int64_t trials = 0, answered = 0;
  std::int64_t interrupted = 0;  ///< presentations cut short
  bool ended = false;
  std::string state;  ///< "open", "done", "refused", "not eligible", "stopped" or "dropped out"
  std::int64_t units = 0, done = 0;   ///< pages and trials
  std::int64_t excluded = 0;          ///< trials
  std::optional<bool> gaze, sharing;  ///< allowed; none: not asked
};

struct StudyStatus {
  std::vector<ProtocolRow> protocols;
  std::vector<SessionRow> sessions;    ///< by protocol, then in the order of planning
  std::vector<std::string> withdrawn;  ///< codes of those who withdrew
  std::int64_t frames = 0;
  std::int64_t gaze = 0;  ///< samples
  std::string lacking;    ///< rows that only its journal holds (open_study.hpp); empty: none
};
StudyStatus read_status(const StudyFile& study);

/// Timing of all answered presentations of one cell: one line of the certificate.
struct CertificateRow {
  StimulusSpec what;
  FpsSetting nominal;       ///< moments 0: as fast as the method ran, without verdicts
  std::int64_t trials = 0;  ///< presentations
  double mean = 0;          ///< mean over the trials of the realised mean, frames/s
  double mean_worst = 0;    ///< largest distance from nominal, frames/s
  double sd = 0;            ///< mean over the trials of the realised sd, frames/s
  double sd_worst = 0;
  std::int64_t frames = 0, late = 0;
  double worst_late_ms = 0;
  std::int64_t pass = 0, degraded = 0, fail = 0;
  std::string grades;  ///< grades of the evidence that occur, best first
};

/// Certificate rows of the sessions of run `run_id`; `mean` is the kind of mean in the protocol's settings.
std::vector<CertificateRow> read_certificate(const std::filesystem::path& database, std::int64_t run_id,
                                             FpsMean mean);

}  // namespace study
