#pragma once
/// The bakes that a session plays: which stand for which cells, and what is said of the others.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/bakes/bake_plan.hpp"

namespace apps {

/// A bake that stands for a stimulus.
struct FoundBake {
  std::filesystem::path path;
  sim::BakeHeader header;
  std::string hash;  ///< BakeReader::content_hash
};

/// Of one file, which stands for every cell, or of a folder of `vip-study bake --protocol`, or none.
class SessionBakes {
 public:
  SessionBakes() = default;
  /// `path`: of `vip-study run --stimulus`; empty: no bake. base::Error: a file for several stimuli, a folder
  /// without any bake of the protocol, a bake in it that holds another fluid than the session wants, or
  /// levels that followed a picture or an angle other than the session's.
  SessionBakes(const std::filesystem::path& path, const study::Protocol& protocol, const SessionLook& look);

  /// None: the cell runs live.
  const FoundBake* of(const study::Cell& cell) const;
  /// No cell runs live.
  bool whole() const;
  /// In what a single file departs from the protocol, such as "n_* 2048 instead of 32768"; empty: in nothing.
  /// Data of such a session are test data.
  const std::string& departure() const { return departure_; }
  /// Of a folder: how many stimuli are baked and live and why, and which could be baked and are missing. A
  /// line each. protocol_file: as on the command line.
  std::vector<std::string> notes(const std::string& protocol_file) const;
  /// Of a folder: each stimulus with the hash of its bake, or "live"; for the record.
  std::string description() const;

 private:
  struct Source {
    PlannedStimulus planned;
    std::shared_ptr<const FoundBake> bake;  ///< none: live
  };

  void use_file(const study::Protocol& protocol, const SessionLook& look);
  void use_folder(const study::Protocol& protocol, const SessionLook& look);

  std::filesystem::path path_;
  std::vector<Source> sources_;
  std::string departure_, options_;
};

}  // namespace apps
