#pragma once
/// Programs beside each other on one database.

#include <filesystem>
#include <string>

namespace faults {

namespace fs = std::filesystem;

struct Together {
  long programs = 0;    ///< started beside another
  long refused = 0;     ///< of which with one clear error
  std::string problem;  ///< what was lost or refused without need; empty: nothing
};

/// `count` first starts at one time on a new database in `folder`, each with a participant of its own: who
/// ends well has their whole session in it, and who was refused can do it again.
Together start_together(const fs::path& folder, int count);

/// A session with `vip-study status` again and again beside it.
Together look_beside(const fs::path& folder);

}  // namespace faults
