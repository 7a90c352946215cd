#include "libstudy/markers/marker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "libstudy/base/clock.hpp"
#include "stats/base/utc.hpp"
#include "stats/quantiles.hpp"

namespace study {

namespace {

constexpr int session_codes = 64, trial_codes = 128;

std::string known(std::int64_t number, std::int64_t least) {
  return number < least ? std::string() : std::to_string(number);
}

/// "median 0.200 ms, 95 % 0.300 ms, longest 0.400 ms".
std::string quantiles_of(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  return fmt::format("median {:.3f} ms, 95 % {:.3f} ms, longest {:.3f} ms", stats::sorted_quantile(ms, 0.5),
                     stats::sorted_quantile(ms, 0.95), ms.back());
}

/// Times from event to completed write at one receiver, ms.
struct Latencies {
  std::vector<double> all, onsets;
  std::size_t lost = 0;
};

std::string line_of(const std::string& receiver, const Latencies& found) {
  std::string line =
      fmt::format("markers to {}: {} written, {} lost", receiver, found.all.size(), found.lost);
  if (!found.all.empty()) line += "; from event to completed write: " + quantiles_of(found.all);
  if (!found.onsets.empty())
    line += fmt::format("; of {} stimulus onsets: ", found.onsets.size()) + quantiles_of(found.onsets);
  return line + '\n';
}

}  // namespace

std::string marker_name(MarkerKind kind) {
  switch (kind) {
    case MarkerKind::SessionBegin:
      return "session_begin";
    case MarkerKind::SessionEnd:
      return "session_end";
    case MarkerKind::TrialBegin:
      return "trial_begin";
    case MarkerKind::TrialEnd:
      return "trial_end";
    case MarkerKind::StimulusOnset:
      return "stimulus_onset";
    case MarkerKind::QuestionShown:
      return "question_shown";
    case MarkerKind::AnswerGiven:
      return "answer_given";
    case MarkerKind::PauseBegin:
      return "pause_begin";
    case MarkerKind::PauseEnd:
      return "pause_end";
    case MarkerKind::Cut:
      return "cut";
    case MarkerKind::Test:
      break;
  }
  return "test";
}

int marker_code(const Marker& marker) {
  switch (marker.kind) {
    case MarkerKind::SessionBegin:
      return session_codes + marker.slot % session_codes;
    case MarkerKind::TrialBegin:
      return trial_codes + std::max(0, marker.position) % trial_codes;
    case MarkerKind::SessionEnd:
      return 1;
    case MarkerKind::TrialEnd:
      return 2;
    case MarkerKind::StimulusOnset:
      return marker.stimulus == 2 ? 4 : 3;
    case MarkerKind::QuestionShown:
      return 5;
    case MarkerKind::AnswerGiven:
      return 6;
    case MarkerKind::PauseBegin:
      return 7;
    case MarkerKind::PauseEnd:
      return 8;
    case MarkerKind::Cut:
      return 9;
    case MarkerKind::Test:
      break;
  }
  return 10;
}

std::string marker_code_table() {
  std::string table = "code     event\n0        rest: the byte between two markers\n";
  Marker marker;
  for (const MarkerKind kind : {MarkerKind::SessionEnd, MarkerKind::TrialEnd, MarkerKind::StimulusOnset,
                                MarkerKind::QuestionShown, MarkerKind::AnswerGiven, MarkerKind::PauseBegin,
                                MarkerKind::PauseEnd, MarkerKind::Cut, MarkerKind::Test}) {
    marker.kind = kind;
    const bool onset = kind == MarkerKind::StimulusOnset;
    for (marker.stimulus = 1; marker.stimulus <= (onset ? 2 : 1); ++marker.stimulus)
      table += fmt::format("{:<8} {}{}\n", marker_code(marker), marker_name(kind),
                           !onset                 ? ""
                           : marker.stimulus == 1 ? " of the first or only stimulus"
                                                  : " of the second stimulus of a pair");
  }
  return table + fmt::format(
                     "{:<8} session_begin: 64 + slot of the participant, modulo 64\n"
                     "{:<8} trial_begin: 128 + position in the session, modulo 128\n",
                     "64-127", "128-255");
}

std::int64_t utc_ns_of(std::int64_t clock_ns) {
  using namespace std::chrono;
  const auto now_ns = duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
  return now_ns - RealClock().now_ns() + clock_ns;
}

std::string marker_utc(std::int64_t utc_ns) {
  const std::int64_t us = utc_ns / 1000;
  const std::string seconds = base::utc_of_seconds(us / 1'000'000);
  return fmt::format("{}.{:06d}Z", seconds.substr(0, seconds.find('Z')), us % 1'000'000);
}

std::string marker_header() { return "event,code,slot,position,attempt,stimulus,clock_ns,display_ns,utc\n"; }

std::string marker_line(const Marker& marker) {
  return fmt::format("{},{},{},{},{},{},{},{},{}\n", marker_name(marker.kind), marker_code(marker),
                     marker.slot, known(marker.position, 0), known(marker.attempt, 1),
                     known(marker.stimulus, 1), marker.clock_ns, known(marker.display_ns, 0),
                     marker_utc(marker.utc_ns));
}

std::string marker_tags(const Marker& marker) {
  std::string tags = fmt::format("{}/slot {}", marker_name(marker.kind), marker.slot);
  if (marker.position >= 0) tags += fmt::format("/position {}", marker.position);
  if (marker.attempt > 0) tags += fmt::format("/attempt {}", marker.attempt);
  if (marker.stimulus > 0) tags += fmt::format("/stimulus {}", marker.stimulus);
  return tags;
}

std::string marker_summary(std::span<const MarkerRecord> records) {
  std::map<std::string, Latencies> receivers;
  for (const MarkerRecord& record : records) {
    Latencies& found = receivers[record.receiver];
    const double ms = 1e-6 * static_cast<double>(record.written_ns - record.marker.clock_ns);
    if (!record.lost.empty()) {
      ++found.lost;
      continue;
    }
    found.all.push_back(ms);
    if (record.marker.kind == MarkerKind::StimulusOnset) found.onsets.push_back(ms);
  }
  std::string text;
  for (const auto& [receiver, found] : receivers) text += line_of(receiver, found);
  return text;
}

}  // namespace study
