#pragma once
/// The SQLite file of an accuracy sweep. It has a row for each cell, and stores the cell's states of the
/// water, times of frames and pictures. Errors are not stored; they are computed when a table is made.

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/sweep/cell_run.hpp"
#include "libstudy/sweep/matrix.hpp"

namespace study {

/// SQLite's application_id of sweep files: "ViPS" in ASCII.
inline constexpr std::int64_t sweep_application_id = 0x56695053;

/// Machine, program and scene file with which a cell was run. Only cells in which all three are equal are
/// compared.
struct SweepOrigin {
  std::string machine;  ///< processor model, logical processors, device and threads
  std::string program;  ///< version of the program and digest of its binary
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
  /// Opens the file. Open::Create also creates a missing file or fills an empty one. base::Error, and the
  /// file is not changed, if it is no sweep file, has another schema version or is damaged.
  SweepFile(const std::filesystem::path& path, sqlite::Open how);

  /// Adds the cell in one transaction. Does nothing if the file has a row with its key and machine.
  void add(const StoredCell& cell);
  /// Keys of the cells that were run on this machine.
  std::set<std::string> keys(const std::string& machine);
  /// All cells, ordered by origin, scene, setting, run length, picture sizes and seed. The order does not
  /// depend on when they were run.
  std::vector<StoredCell> cells();
  /// Adds those cells of the sweep file `shard` whose key and machine this file lacks, in one transaction.
  /// Returns their number.
  std::int64_t merge(const std::filesystem::path& shard);

 private:
  std::unique_ptr<sqlite::Connection> database_;
};

}  // namespace study
