#pragma once
/// Which study a reader opens, and on what terms.

#include <concepts>
#include <filesystem>

namespace study {

/// A path alone will do: the study must then be whole.
struct StudyFile {
  template <class Path>
    requires std::convertible_to<const Path&, std::filesystem::path>
  StudyFile(const Path& database, bool go_on = false) : path(database), incomplete(go_on) {}

  std::filesystem::path path;
  bool incomplete = false;  ///< go on with what the database holds where its journal holds more
};

}  // namespace study
