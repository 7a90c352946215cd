#pragma once
/// Markers: events of a session that are sent to recording systems, such as EEG and eye trackers. A marker
/// holds no participant code, no answer and no words.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace study {

enum class MarkerKind {
  SessionBegin,
  SessionEnd,
  TrialBegin,     ///< a showing of a trial begins
  TrialEnd,       ///< the last question of a trial was answered
  StimulusOnset,  ///< the first frame of a stimulus was handed to the display
  QuestionShown,  ///< a page with questions is on the display
  AnswerGiven,    ///< that page was confirmed
  PauseBegin,     ///< a rest, a break, or a pause of experimenter or program
  PauseEnd,
  Cut,  ///< a showing ended before its end
  Test  ///< sent by vip-study markers --test
};

/// One event of a session.
struct Marker {
  MarkerKind kind = MarkerKind::Test;
  int slot = 0;                  ///< position of the participant in the assignment (Plan::slot), from 0
  int position = -1;             ///< position of the unit (trial or page) in the session, from 0; -1: no unit
  int attempt = 0;               ///< showing of the trial, from 1; 0: not in a trial
  int stimulus = 0;              ///< 1: the first or only stimulus of a trial, 2: the second; 0: no stimulus
  std::int64_t clock_ns = 0;     ///< the event on the computer's clock (CLOCK_MONOTONIC), ns
  std::int64_t display_ns = -1;  ///< of a stimulus: predicted time on the display; -1: not known
  std::int64_t utc_ns = 0;       ///< the event in UTC, ns since 1970, by this computer's clock
};

/// A marker, and what became of it at one receiver.
struct MarkerRecord {
  Marker marker;
  std::string receiver;         ///< as --markers names it
  std::int64_t written_ns = 0;  ///< completed write on that clock, ns; only if not lost
  std::string lost{};           ///< why the receiver did not get it; empty: it was written
};

/// "stimulus_onset" and so on.
std::string marker_name(MarkerKind kind);
/// The byte of a marker, 1 to 255; 0 is rest. Begins carry a number: 64 + slot modulo 64 for a session,
/// 128 + position modulo 128 for a trial. docs/session.md has the table.
int marker_code(const Marker& marker);

/// Every code with its event, as lines of a table.
std::string marker_code_table();

/// A time on the computer's clock (CLOCK_MONOTONIC) in UTC, ns since 1970.
std::int64_t utc_ns_of(std::int64_t clock_ns);
/// Text of a UTC time with microseconds, such as "2026-11-29T23:30:00.123456Z".
std::string marker_utc(std::int64_t utc_ns);

/// Names of the columns of marker_line(), separated by commas, with a line feed.
std::string marker_header();
/// One line of CSV with a line feed. Unknown numbers are empty.
std::string marker_line(const Marker& marker);
/// The marker as tags separated by "/": "stimulus_onset/slot 3/position 7/stimulus 1".
std::string marker_tags(const Marker& marker);

/// A line for each receiver: markers written and lost, and median, 95th percentile and maximum of the time
/// from event to completed write. Empty without records.
std::string marker_summary(std::span<const MarkerRecord> records);

}  // namespace study
