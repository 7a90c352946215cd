#pragma once
/// Names of verdicts, grades, levels and some events in the database, the certificate and the exports.

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/pacing/pacer.hpp"

namespace study {

/// Event kinds: the experimenter revealed the setting of a trial, or opened the mirror (the experimenter's
/// second window) with stimuli visible. The experimenter is then no longer blind to the session.
inline constexpr const char* revealed_event = "setting revealed";
inline constexpr const char* mirror_event = "mirror opened";
/// Event kind: the mirror showed pages but no stimulus, so the experimenter stayed blind to the session.
inline constexpr const char* pages_mirror_event = "pages mirrored";
/// Event kind: the session was imported; the detail names the tool and the hashes of source and mapping.
inline constexpr const char* imported_event = "imported";

/// The inverse of verdict_name(). Returns Fail for any other name; the schema's CHECK excludes other names.
inline Verdict verdict_of(const std::string& name) {
  if (name == "pass") return Verdict::Pass;
  return name == "degraded" ? Verdict::Degraded : Verdict::Fail;
}

inline std::string grade_name(TimingGrade grade) { return std::string(1, static_cast<char>(grade)); }

inline TimingGrade grade_of(const std::string& name) {
  for (const auto grade : {TimingGrade::Photodiode, TimingGrade::DisplayFeedback, TimingGrade::Compositor}) {
    if (name == grade_name(grade)) return grade;
  }
  return TimingGrade::CpuSubmit;
}

/// Factors and their levels from the column cell.levels, which has one line "factor = level" for each. A line
/// of another form is left out.
inline std::vector<std::pair<std::string, std::string>> factor_levels(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (const auto at = line.find(" = "); at != std::string::npos)
      out.emplace_back(line.substr(0, at), line.substr(at + 3));
  }
  return out;
}

}  // namespace study
