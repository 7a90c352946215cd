#pragma once
/// The bakes that a session plays: which bake shows which cell, notes about the other cells, and bakes that
/// were moved since sessions began with them.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/stimulus/bakes/bake_plan.hpp"

namespace study {

/// A bake that shows a stimulus.
struct FoundBake {
  std::filesystem::path path;
  sim::BakeHeader header;
  std::string hash;  ///< BakeReader::content_hash
};

/// Bakes from one file, which shows every cell, or from a folder of `vip-study bake --protocol`, or none.
class SessionBakes {
 public:
  SessionBakes() = default;
  /// `path`: of `vip-study run --stimulus`; empty: no bake. base::Error: a file for several stimuli, a folder
  /// without any bake of the protocol, or a bake in it whose fluid differs from the session's or whose levels
  /// followed another picture or angle.
  SessionBakes(const std::filesystem::path& path, const Protocol& protocol, const SessionLook& look);

  /// The bake of a cell; null if the cell runs live.
  const FoundBake* of(const Cell& cell) const;
  /// True if no cell runs live.
  bool whole() const;
  /// How a single file departs from the protocol, such as "n_* 2048 instead of 32768"; empty: not at all.
  /// Data of a departing session are test data.
  const std::string& departure() const { return departure_; }
  /// For a folder: how many stimuli are baked, which run live and why, and which bakes are missing. One line
  /// each. protocol_file: as on the command line.
  std::vector<std::string> notes(const std::string& protocol_file) const;
  /// For a folder: each stimulus with the hash of its bake, or "live"; for the record.
  std::string description() const;

 private:
  struct Source {
    PlannedStimulus planned;
    std::shared_ptr<const FoundBake> bake;  ///< none: live
  };

  void use_file(const Protocol& protocol, const SessionLook& look);
  void use_folder(const Protocol& protocol, const SessionLook& look);

  std::filesystem::path path_;
  std::vector<Source> sources_;
  std::string departure_, options_;
};

/// The bakes that resumed sessions were played from.
struct RecordedBake {
  std::string path;   ///< file or folder; empty: no bake
  std::string shown;  ///< recorded description of the stimuli, with the hash of each bake
};

/// For each of `recorded`, the current path of its bakes: the first of `given` (options --stimulus) that
/// holds all of them, by their hashes, else the recorded path. base::Error, with the hashes, for an unused
/// path of `given`, and for a recorded path that no longer exists.
std::vector<std::string> find_bakes(const std::vector<RecordedBake>& recorded,
                                    const std::vector<std::string>& given, const std::string& database);

}  // namespace study
