#pragma once
/// Runs programs in parallel on one database.

#include <filesystem>
#include <string>

namespace faults {

namespace fs = std::filesystem;

struct Together {
  long programs = 0;    ///< started in parallel with another
  long refused = 0;     ///< of these, refused with one clear error
  std::string problem;  ///< lost data or an unneeded refusal; empty: none
};

/// Starts `count` programs at one time on a new database in `folder`, each with its own participant. A
/// program that ends well must have its whole session in the database, and one that was refused must be able
/// to retry.
Together start_together(const fs::path& folder, int count);

/// Runs a session and, repeatedly in parallel, `vip-study status`.
Together look_beside(const fs::path& folder);

}  // namespace faults
