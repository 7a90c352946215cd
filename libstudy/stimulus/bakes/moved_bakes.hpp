#pragma once
/// Finds bakes that were moved since sessions began with them.

#include <string>
#include <vector>

namespace study {

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
