#pragma once
/// The SQLite file of an accuracy sweep: one row per cell with the state of its water and the times of its
/// frames. Errors are not stored; they are computed from the rows when a table is made.

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/sweep/cell_run.hpp"
#include "libstudy/sweep/matrix.hpp"

namespace study {

/// SQLite's application_id of these files: "ViPS".
inline constexpr std::int64_t sweep_application_id = 0x56695053;

/// The circumstances of a cell's run. Only cells with equal machine, program and scene file are compared.
struct SweepOrigin {
  std::string machine;  ///< processor, cores, device and threads
  std::string program;  ///< version and digest of the program's binary
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
  /// Open::Create makes a missing or empty file. base::Error, without changing the file, if it belongs to
  /// another program or to another version of this one, or is damaged.
  SweepFile(const std::filesystem::path& path, sqlite::Open how);

  /// Adds the cell in one transaction; does nothing if the machine has a row for this key.
  void add(const StoredCell& cell);
  /// Keys of the cells that this machine has run.
  std::set<std::string> keys(const std::string& machine);
  /// Ordered by origin, scene, setting and seed, never by time of run.
  std::vector<StoredCell> cells();
  /// Adds the cells of another sweep file that are missing here, in one transaction; returns their number.
  std::int64_t merge(const std::filesystem::path& shard);

 private:
  std::unique_ptr<sqlite::Connection> database_;
};

}  // namespace study
