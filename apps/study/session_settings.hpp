#pragma once
/// The solver settings of `vip-study run --setting`: which live cells run at which of them.

#include <string>
#include <vector>

#include "apps/common/setting_file.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// A setting holds for every cell of its method and n_*, whatever the scene, so that a method is one method
/// in all scenes of a study. Cells that none is for run as the programs do without one.
class SessionSettings {
 public:
  SessionSettings() = default;
  /// `texts`: setting files in full; `place` names them in errors. base::Error: a file that cannot be read,
  /// that is for a method and n_* of no cell or that another one is for, or whose frames of content are not
  /// as far apart as the protocol's.
  SessionSettings(const std::vector<std::string>& texts, const study::Protocol& protocol,
                  const std::string& place);

  /// None: the cell has the usual setting.
  const SettingFile* of(const study::StimulusSpec& stimulus) const;
  bool empty() const { return settings_.empty(); }
  /// For the record: "; at setting SHA-256 (Ours n_star=16384 ...)" for each; empty: none.
  std::string description() const;
  /// Lines for each setting: what it is and cost where it was measured, and where this study is another
  /// place.
  std::vector<std::string> notes(const study::Protocol& protocol) const;

 private:
  struct Setting {
    SettingFile file;
    std::string sha256;
  };
  std::vector<Setting> settings_;
};

}  // namespace apps
