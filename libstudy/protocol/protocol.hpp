#pragma once
/// A study as its file describes it: plain structs, checked, hashed. One translation unit reads the file.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libstudy/pacing/pacer.hpp"
#include "libstudy/pacing/schedule.hpp"

namespace study {

/// What is shown; libstudy only passes these words on.
struct StimulusSpec {
  std::string scene;   ///< scene file
  std::string method;  ///< "HiRes", ...
  std::string n_star;  ///< "32k"
};

/// A rating question with its exact wording.
struct Question {
  std::string id;
  std::string text;
  std::string language;
  int scale_min = 1;
  int scale_max = 7;
  /// (score, words) in ascending order of score.
  std::vector<std::pair<int, std::string>> anchors;
};

struct Protocol {
  static constexpr int format_version = 1;

  std::string name;
  std::string version;
  StimulusSpec stimulus;
  std::vector<FpsSetting> settings;  ///< every cell of the design, in file order; trial i of a plan names one
  double gap_s = 3;                  ///< pause before each trial
  PacingRules pacing;
  ContentRules content;
  TimingTolerance timing;
  Question question;
  int participants = 16;  ///< planned
  bool accept_approximate = false;
  /// True when the command line changed it (--trial-seconds ...): data are marked as test and the hash
  /// differs.
  bool test_data = false;
  /// What override_trial_seconds() was given; none = every trial is as long as the file says. text and this
  /// together rebuild the protocol.
  std::optional<double> trial_seconds;

  std::string text;    ///< the file as read, kept in every database
  std::string sha256;  ///< of `text`, or of text + overrides when there are any
};

/// Reads a protocol; base::Error at file:line:column for an unknown key, a wrong type, a value out of range
/// or two keys that contradict each other. `name` stands for the file in messages.
Protocol parse_protocol(std::string_view text, const std::string& name);
Protocol read_protocol(const std::filesystem::path& path);
/// Sets the length of every trial, 0.1 to 3600 s; changes the hash and marks the data as test. Equal texts
/// and seconds give equal hashes.
void override_trial_seconds(Protocol& protocol, double seconds);

}  // namespace study
