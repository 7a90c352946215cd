#pragma once
/// The study that a reader opens, and whether it may be incomplete.

#include <concepts>
#include <filesystem>

namespace study {

/// The study that a reader opens. A path alone converts to a study that must be complete.
struct StudyFile {
  template <class Path>
  requires std::convertible_to<const Path&, std::filesystem::path> StudyFile(const Path& database,
                                                                             bool go_on = false)
      : path(database), incomplete(go_on) {}

  std::filesystem::path path;
  bool incomplete = false;  ///< accept a database with fewer rows than its journal
};

}  // namespace study
