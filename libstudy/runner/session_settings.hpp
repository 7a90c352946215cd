#pragma once
/// The solver settings of `vip-study run --setting`, by live cell.

#include <string>
#include <vector>

#include "libsim/setting/setting_file.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// A setting applies to every cell of its method and n_* in all scenes, so that a method is the same in all
/// scenes of a study. Other cells use the default setting.
class SessionSettings {
 public:
  SessionSettings() = default;
  /// `texts`: setting files in full; `place` names them in errors. base::Error: a file that cannot be read,
  /// whose method and n_* match no cell or another file, or whose content step differs from the protocol's.
  SessionSettings(const std::vector<std::string>& texts, const Protocol& protocol, const std::string& place);

  /// Null: the cell has the default setting.
  const sim::SettingFile* of(const StimulusSpec& stimulus) const;
  bool empty() const { return settings_.empty(); }
  /// For the record: "; at setting SHA-256 (Ours n_star=16384 ...)" for each; empty: none.
  std::string description() const;
  /// Lines for each setting: its content and measured cost, scenes that differ from the measured one, and
  /// whether tau is fixed.
  std::vector<std::string> notes(const Protocol& protocol) const;

 private:
  struct Setting {
    sim::SettingFile file;
    std::string sha256;
  };
  std::vector<Setting> settings_;
};

}  // namespace study
