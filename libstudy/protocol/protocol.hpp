#pragma once
/// A study as described by its file: plain structs, checked and hashed. One translation unit reads the file.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/block.hpp"
#include "libstudy/protocol/design.hpp"
#include "libstudy/protocol/headset_rules.hpp"

namespace study {

struct Protocol {
  static constexpr int format_version = 2;

  std::string name;
  std::string version;
  std::string language;
  int participants = 16;  ///< planned
  Design design;
  std::vector<Block> blocks;  ///< in the order of the session
  PacingRules pacing;
  ContentRules content;
  TimingTolerance timing;
  HeadsetRules headset;
  bool accept_approximate = false;
  /// Allows comparing stimuli whose pictures differ in renderer, size or angle, as baked and live ones can.
  bool accept_mixed_pictures = false;
  /// Participants are instructed to look at the middle of the picture, so the gaze point is known in advance.
  bool fixation = false;
  /// H1 and H5 need gaze: without tracked gaze they are labelled not testable.
  bool needs_gaze = false;
  /// The camera uses the visual angle of the picture instead of each scene's own angle.
  bool true_angle = false;
  /// True if the command line changed it (--trial-seconds ...): data are marked as test and the hash differs.
  bool test_data = false;
  /// Argument of override_trial_seconds(); none = trial lengths of the file. `text` and this rebuild the
  /// protocol.
  std::optional<double> trial_seconds;

  std::string place;   ///< name of the file in messages; empty: rebuilt from tables
  std::string text;    ///< the file as read, stored in every database
  std::string sha256;  ///< of `text`, or of text + overrides when there are any
};

/// Every question of the protocol with its block's index, in the order of the file.
std::vector<std::pair<int, const Question*>> all_questions(const Protocol& protocol);

/// Stored: accepts protocols of earlier versions, which allowed any method name and question id and any form
/// of gaze_question and sharing_question.
enum class ProtocolUse { New, Stored };

/// Reads a protocol; base::Error at file:line:column for an unknown key, a wrong type, a value out of range
/// or two keys that contradict each other. `name` names the file in messages.
Protocol parse_protocol(std::string_view text, const std::string& name, ProtocolUse use = ProtocolUse::New);
Protocol read_protocol(const std::filesystem::path& path);
/// Sets the length of every trial, 0.1 to 3600 s; changes the hash and marks the data as test. Equal texts
/// and seconds give equal hashes.
void override_trial_seconds(Protocol& protocol, double seconds);

}  // namespace study
