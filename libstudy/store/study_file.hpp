#pragma once
/// The study that a reader opens, with a flag for accepting an incomplete database.

#include <concepts>
#include <filesystem>

namespace study {

/// The database that a reader opens. A path converts to a StudyFile whose database must have all rows of its
/// journal of answers.
struct StudyFile {
  template <class Path>
  requires std::convertible_to<const Path&, std::filesystem::path> StudyFile(const Path& database,
                                                                             bool go_on = false)
      : path(database), incomplete(go_on) {}

  std::filesystem::path path;
  bool incomplete = false;  ///< true: accepts a database that lacks rows of its journal of answers
};

}  // namespace study
