#pragma once
/// Reads the protocols and sessions of a database with their counts, and timing certificates. Does not change
/// the database. base::Error if the database cannot be opened (open_study()).

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/pacing/schedule.hpp"
#include "libstudy/protocol/design.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// For a cell of a protocol with factors: the number of trials of stimulus blocks that show it, and how many
/// of them are answered. A trial whose cell an adaptive procedure has yet to choose counts for the first of
/// the cells among which the procedure chooses.
struct CellCount {
  std::vector<std::pair<std::string, std::string>> levels;  ///< factor and level
  std::int64_t trials = 0, answered = 0;
};

/// A protocol, with the counts of its dataset: the data of all sessions under the same protocol hash.
struct ProtocolRow {
  std::int64_t id = 0;
  std::string name, version, sha256;
  std::string text;  ///< full text of the protocol file
  std::optional<double> trial_seconds;
  bool test_data = false;
  std::int64_t sessions = 0, trials = 0, answered = 0;
  std::vector<CellCount> cells = {};  ///< by cell; empty: the protocol has no factors
};

struct SessionRow {
  std::int64_t protocol_id = 0;
  std::string participant;
  int visit = 1;
  std::string observer;  ///< simulated observer that answered; empty = a person
  std::string clock;     ///< "real" or "virtual"
  bool test_data = false;
  std::int64_t trials = 0, answered = 0;
  std::int64_t interrupted = 0;  ///< number of presentations that were cut short
  bool ended = false;
  std::string state;  ///< "open", "done", "refused", "not eligible", "stopped" or "dropped out"
  std::int64_t units = 0, done = 0;   ///< pages and trials: all, and those that are done
  std::int64_t excluded = 0;          ///< number of excluded trials
  std::optional<bool> gaze, sharing;  ///< true: allowed; false: refused or unanswered; none: not asked
  /// Program that recorded the session elsewhere, and the SHA-256 of its source; empty: not imported.
  std::string imported_from = {}, source_sha256 = {};
  std::int64_t not_recorded = 0;  ///< number of showings without a recorded frame
  std::int64_t stated = 0;        ///< number of those whose frame rate the source of an import states
  std::int64_t showings = 0;      ///< number of stimuli shown to their end
};

struct StudyStatus {
  std::vector<ProtocolRow> protocols;
  std::vector<SessionRow> sessions;    ///< by protocol, then in the order of planning
  std::vector<std::string> withdrawn;  ///< codes of people who withdrew
  std::int64_t frames = 0;
  std::int64_t gaze = 0;  ///< number of gaze samples
  /// how the database lags behind its journal of answers, in words (OpenedStudy::lacking); empty: it does not
  std::string lacking;
};
StudyStatus read_status(const StudyFile& study);

/// Timing of all presentations of one cell that an answer judges: one line of the timing certificate.
struct CertificateRow {
  StimulusSpec what;
  FpsSetting nominal;       ///< mean and sd 0: as fast as the method ran, without timing verdicts
  std::int64_t trials = 0;  ///< number of presentations
  double mean = 0;          ///< realised mean frame rate, averaged over the presentations, frames/s
  double mean_worst = 0;    ///< largest |realised mean - nominal mean| of a presentation, frames/s
  double sd = 0;            ///< realised sd of the frame rate, averaged over the presentations, frames/s
  double sd_worst = 0;      ///< largest |realised sd - nominal sd| of a presentation, frames/s
  std::int64_t frames = 0, late = 0;
  double worst_late_ms = 0;
  std::int64_t pass = 0, degraded = 0, fail = 0;
  std::string grades;  ///< distinct grades (TimingGrade: evidence for onset times), best first: "A,D"
  /// Only of a protocol with factors: factor and level, and the timing profile in words.
  std::vector<std::pair<std::string, std::string>> levels;
  std::string timing;
  double p99_ms = 0;      ///< 99th percentile of the frame intervals, mean over the presentations
  double longest_ms = 0;  ///< largest interval of all presentations
  double hitches = 0;     ///< intervals longer than 1.5 times the median, mean over the presentations
  /// Mean |step of simulated time - frame interval| of a presentation, averaged over the presentations; none:
  /// content followed frames instead of time.
  std::optional<double> animation_error_ms;
};

/// Certificate rows of all sessions of run `run_id`. mean: harmonic or arithmetic, the mean frame rate that
/// the protocol's settings use.
std::vector<CertificateRow> read_certificate(const std::filesystem::path& database, std::int64_t run_id,
                                             FpsMean mean);
/// Certificate rows of all sessions under protocol `protocol_id`.
std::vector<CertificateRow> read_certificate_of_protocol(const StudyFile& study, std::int64_t protocol_id,
                                                         FpsMean mean);

}  // namespace study
