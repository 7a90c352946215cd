#pragma once
/// The solver settings that `vip-study run --setting` gives to live cells.

#include <string>
#include <vector>

#include "libsim/setting/setting_file.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// A setting applies to every cell with its method and n_* (number of particles if all are coarsest), in all
/// scenes, so that a method has the same setting in all scenes of a study. Other cells use the default
/// setting.
class SessionSettings {
 public:
  SessionSettings() = default;
  /// `texts`: the full texts of setting files; `place` names them in errors. base::Error for a text that is
  /// no setting file, whose method and n_* match no cell, whose method and n_* equal those of another text,
  /// or whose content step differs from the protocol's.
  SessionSettings(const std::vector<std::string>& texts, const Protocol& protocol, const std::string& place);

  /// The setting of this stimulus; null: the default setting.
  const sim::SettingFile* of(const StimulusSpec& stimulus) const;
  bool empty() const { return settings_.empty(); }
  /// Text for the record: "; at setting SHA-256 (Ours n_star=16384 ...)" for each setting; empty without
  /// settings.
  std::string description() const;
  /// Lines for each setting: its content and measured cost, a note for each shown scene other than the
  /// measured scene, and a note if the method's tolerance tau (frames/s) is computed from the setting's knob
  /// beta instead of the frame rate.
  std::vector<std::string> notes(const Protocol& protocol) const;

 private:
  struct Setting {
    sim::SettingFile file;
    std::string sha256;
  };
  std::vector<Setting> settings_;
};

}  // namespace study
