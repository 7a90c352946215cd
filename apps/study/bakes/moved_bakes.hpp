#pragma once
/// Bakes that were moved since sessions began with them.

#include <string>
#include <vector>

namespace apps {

/// What sessions that are resumed were played from.
struct RecordedBake {
  std::string path;   ///< file or folder; empty: no bake
  std::string shown;  ///< what they were shown, in the record's words, with the hash of each bake
};

/// For each of `recorded` the path at which its bakes stand now: the first of `given` (options --stimulus)
/// that holds all of them, by their hashes, else the recorded path. base::Error, with the hashes, for a path
/// of `given` that is of no use, and for a recorded path that is not there any more.
std::vector<std::string> find_bakes(const std::vector<RecordedBake>& recorded,
                                    const std::vector<std::string>& given, const std::string& database);

}  // namespace apps
