#pragma once
/// The answers of a study as the analyses see them. Read-only: nothing in the database is changed.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/pacing/pacer.hpp"

namespace study {

/// One question on a scale about one planned trial of one stimulus, with what is known of it so far.
struct RatingRow {
  std::string participant;  ///< code
  std::string observer;     ///< simulated observer that answered; empty = a person
  std::string protocol_name;
  std::string protocol_sha256;  ///< 64 hexadecimal digits, overrides included
  bool test_data = false;       ///< pilot runs and overridden protocols: never pooled with real data
  bool practice = false;
  bool repeat = false;    ///< shown again for test-retest
  bool excluded = false;  ///< by the experimenter
  std::string question;   ///< id
  int position = 0;       ///< 0-based order of presentation
  FpsSetting nominal;
  int scale_min = 1, scale_max = 7;
  /// How the showing that was judged was shown (the schema's view judgement); empty until there is one, and
  /// without a schedule to judge by.
  std::optional<TimingVerdict> timing;
  /// The answer within [scale_min, scale_max]; empty until given.
  std::optional<int> rating;
};

/// Every planned trial of one stimulus with every scale question about it, answered or not, ordered by
/// (protocol, participant, visit, position, place on the page). base::Error naming the file: missing, not a
/// database of this program, damaged, or newer than this program.
std::vector<RatingRow> read_ratings(const std::filesystem::path& database);

}  // namespace study
