#pragma once
/// The SQLite file of an accuracy sweep: a row for each cell with what its water did and what its frames
/// took. Errors are not in it; they follow from the rows when a table is made.

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/common/sweep/cell_run.hpp"
#include "apps/common/sweep/matrix.hpp"
#include "libstudy/store/sqlite.hpp"

namespace apps {

/// SQLite's application_id of these files: "ViPS".
inline constexpr std::int64_t sweep_application_id = 0x56695053;

/// What a cell ran on and from. Only cells that agree in machine, program and scene file are compared.
struct SweepOrigin {
  std::string machine;  ///< processor, cores, device and threads
  std::string program;  ///< version and digest of the program's bytes
  std::string scene_sha256;
  auto operator<=>(const SweepOrigin&) const = default;
};

struct StoredCell {
  SweepCell cell;
  SweepOrigin origin;
  CellRun run;
  std::string key() const { return key_of(cell, origin.scene_sha256, origin.program); }
};

class SweepFile {
 public:
  /// Open::Create makes a missing or empty file. base::Error, with the file left as it is, for one of another
  /// program or a newer one, or a damaged one.
  SweepFile(const std::filesystem::path& path, study::sqlite::Open how);

  /// In one transaction; nothing where the machine's row for this key is there.
  void add(const StoredCell& cell);
  /// Keys that this machine has run.
  std::set<std::string> keys(const std::string& machine);
  /// Ordered by scene, setting and seed, never by when they ran.
  std::vector<StoredCell> cells();
  /// Takes over the cells of another sweep file that are not here, in one transaction; how many these were.
  std::int64_t merge(const std::filesystem::path& shard);

 private:
  std::unique_ptr<study::sqlite::Connection> database_;
};

}  // namespace apps
