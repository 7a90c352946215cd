#pragma once
/// The bakes (files with precomputed frames of a fluid) that a session plays: which bake shows which cell,
/// and notes about cells without one. Also finds bakes that were moved before a session is resumed.

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

/// The bakes of a session: one file that shows every cell, the files in a folder of `vip-study bake
/// --protocol`, or none.
class SessionBakes {
 public:
  SessionBakes() = default;
  /// `path`: argument of `vip-study run --stimulus`; empty: no bake. base::Error for a single file if the
  /// protocol has several scenes, methods, n_*, levels of effects or surfaces, and for a folder without any
  /// bake of the protocol. base::Error also for a bake in a folder whose fluid differs from the session's, or
  /// whose method chose the particles' levels by the gaze in a picture of another size or angle.
  SessionBakes(const std::filesystem::path& path, const Protocol& protocol, const SessionLook& look);

  /// The bake of a cell; null if the cell runs live.
  const FoundBake* of(const Cell& cell) const;
  /// True if every cell has a bake.
  bool whole() const;
  /// How a single file departs from the protocol, such as "n_* 2048 instead of 32768"; empty: not at all.
  /// Data of a session with a departure are test data.
  const std::string& departure() const { return departure_; }
  /// For a folder: lines about the stimuli that have a bake, the stimuli that run live with the reason, and
  /// the missing bakes. protocol_file: path as on the command line.
  std::vector<std::string> notes(const std::string& protocol_file) const;
  /// Text for the record of a folder: each stimulus with the hash of its bake, or "live". Empty for a single
  /// file.
  std::string description() const;

 private:
  struct Source {
    PlannedStimulus planned;
    std::shared_ptr<const FoundBake> bake;  ///< null: the stimulus runs live
  };

  void use_file(const Protocol& protocol, const SessionLook& look);
  void use_folder(const Protocol& protocol, const SessionLook& look);

  std::filesystem::path path_;
  std::vector<Source> sources_;
  std::string departure_, options_;
};

/// The bakes of an interrupted run, as its sessions recorded them.
struct RecordedBake {
  std::string path;   ///< file or folder; empty: no bake
  std::string shown;  ///< recorded description of the stimuli, with the hash of each bake
};

/// For each entry of `recorded`, the current path of its bakes: the first path in `given` (options
/// --stimulus) that contains all recorded hashes, else the recorded path. base::Error, with the hashes, for
/// an unused path in `given`, and for a recorded path that no longer exists.
std::vector<std::string> find_bakes(const std::vector<RecordedBake>& recorded,
                                    const std::vector<std::string>& given, const std::string& database);

}  // namespace study
