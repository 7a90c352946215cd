#include "libstudy/sweep/sweep_file.hpp"

#include <fmt/core.h>
#include <string_view>

#include "libstudy/store/file/page_file.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"

namespace study {

using study::sqlite::Connection;
using study::sqlite::Open;
using study::sqlite::Statement;
using study::sqlite::Transaction;

namespace {

constexpr std::int64_t schema_version = 2;
constexpr std::string_view sqlite_magic("SQLite format 3\0", 16);
constexpr const char* sample_columns =
    "time_s, front_m, centre_x_m, centre_y_m, centre_z_m, kinetic_j_kg, density_error, density_max";

std::string knob_columns(const char* after) {
  std::string out;
  for (const auto& traits : sim::solver_knobs()) out += std::string(traits.column) + after + ", ";
  return out;
}

/// Columns of the table `cell` except its id, in the order in which they are bound and read.
std::string cell_columns() {
  return "key, machine, program, scene_sha256, scene, method, " + knob_columns("") +
         "seed, seconds, picture, kept, particles_mean, substeps_mean, braked, pixels_per_degree";
}
constexpr int columns_before_knobs = 6, columns_after_knobs = 8;

std::string schema() {
  return "CREATE TABLE cell (id INTEGER PRIMARY KEY, key TEXT NOT NULL, machine TEXT NOT NULL, program TEXT "
         "NOT NULL, scene_sha256 TEXT NOT NULL, scene TEXT NOT NULL, method TEXT NOT NULL, " +
         knob_columns(" REAL NOT NULL") +
         "seed INTEGER NOT NULL, seconds REAL NOT NULL, picture TEXT NOT NULL, kept TEXT NOT NULL, "
         "particles_mean REAL NOT NULL, substeps_mean REAL NOT NULL, braked INTEGER NOT NULL, "
         "pixels_per_degree REAL NOT NULL, UNIQUE (key, machine)) STRICT;"
         "CREATE TABLE sample (cell_id INTEGER NOT NULL REFERENCES cell, time_s REAL NOT NULL, front_m REAL "
         "NOT NULL, centre_x_m REAL NOT NULL, centre_y_m REAL NOT NULL, centre_z_m REAL NOT NULL, "
         "kinetic_j_kg REAL NOT NULL, density_error REAL NOT NULL, density_max REAL NOT NULL, PRIMARY KEY "
         "(cell_id, time_s)) STRICT, WITHOUT ROWID;"
         "CREATE TABLE frame (cell_id INTEGER NOT NULL REFERENCES cell, number INTEGER NOT NULL, "
         "solve_ms REAL NOT NULL, draw_ms REAL, PRIMARY KEY (cell_id, number)) STRICT, WITHOUT ROWID;"
         "CREATE TABLE picture (id INTEGER PRIMARY KEY, cell_id INTEGER NOT NULL REFERENCES cell, time_s "
         "REAL "
         "NOT NULL, png BLOB NOT NULL, fovea BLOB NOT NULL, salient BLOB NOT NULL, UNIQUE (cell_id, time_s)) "
         "STRICT;";
}

[[noreturn]] void refuse(const std::filesystem::path& path) {
  throw base::Error(path.string(), "is not a sweep file of vip-bench accuracy",
                    "name the file that it wrote, or a new one");
}

/// Checks in the file's header (sqlite.org/fileformat.html, section 1.3) that it is a sweep file of this
/// version. This precedes any work of SQLite, so that another program's file is not changed.
void recognise(Connection& database, Open how) {
  constexpr std::size_t header_bytes = 100, version_at = 60, application_at = 68;
  const std::string head = database.header();
  if (head.empty() && how == Open::Create) return;
  if (head.size() < header_bytes || !head.starts_with(sqlite_magic) ||
      salvaging::u32(head, application_at) != sweep_application_id)
    refuse(database.path());
  const auto version = salvaging::u32(head, version_at);
  if (version > schema_version) {
    throw base::Error(database.path().string(),
                      fmt::format("was written by a newer program (schema {}, this program knows {})",
                                  version, schema_version),
                      "use the newer vip-bench; the file was left as it is");
  }
  // An older file is not converted, since cells of different programs are never compared.
  if (version > 0 && version < schema_version) {
    throw base::Error(database.path().string(),
                      fmt::format("was written by an older program (schema {}, this program writes {})",
                                  version, schema_version),
                      "name a new file; the older one was left as it is");
  }
}

/// The error does not advise to salvage the file, since a sweep can be computed again.
[[noreturn]] void refuse_damaged(const std::filesystem::path& path) {
  throw base::Error(path.string(), "is damaged or cut short",
                    "name another file, and run the cells of the sweep again into it");
}

StoredCell read_cell(const Statement& row) {
  StoredCell out;
  out.origin = {row.text(2), row.text(3), row.text(4)};
  out.cell.setting.scene = row.text(5);
  out.cell.setting.method = sim::parse_method(row.text(6));
  int column = 1 + columns_before_knobs;
  for (double& value : out.cell.setting.values) value = row.real(column++);
  out.cell.seed = static_cast<int>(row.integer(column++));
  out.cell.seconds = row.real(column++);
  out.cell.size = row.text(column++);
  out.cell.kept = row.text(column++);
  out.run.particles_mean = row.real(column++);
  out.run.substeps_mean = row.real(column++);
  out.run.braked = row.integer(column++);
  out.run.pixels_per_degree = row.real(column);
  return out;
}

void read_run(Connection& database, std::int64_t id, CellRun& run) {
  Statement samples(database,
                    fmt::format("SELECT {} FROM sample WHERE cell_id = ? ORDER BY time_s", sample_columns));
  samples.bind_all(id);
  while (samples.step()) {
    run.samples.push_back({samples.real(0),
                           samples.real(1),
                           {samples.real(2), samples.real(3), samples.real(4)},
                           samples.real(5),
                           samples.real(6),
                           samples.real(7)});
  }
  Statement frames(database, "SELECT solve_ms, draw_ms FROM frame WHERE cell_id = ? ORDER BY number");
  frames.bind_all(id);
  while (frames.step()) {
    run.frames.push_back({frames.real(0), {}});
    if (!frames.is_null(1)) run.frames.back().draw_ms = frames.real(1);
  }
  Statement pictures(database,
                     "SELECT time_s, png, fovea, salient FROM picture WHERE cell_id = ? ORDER BY time_s");
  pictures.bind_all(id);
  while (pictures.step())
    run.pictures.push_back({pictures.real(0), pictures.blob(1), pictures.blob(2), pictures.blob(3)});
}

/// Inserts the cell; must be called within a transaction. Returns false, without an insertion, if the table
/// has a row with this key and machine.
bool insert(Connection& database, const StoredCell& stored) {
  Statement there(database, "SELECT 1 FROM cell WHERE key = ? AND machine = ?");
  there.bind_all(stored.key(), stored.origin.machine);
  if (there.step()) return false;
  const auto& setting = stored.cell.setting;
  std::string marks = "?";
  for (std::size_t i = 1; i < columns_before_knobs + sim::solver_knob_count + columns_after_knobs; ++i)
    marks += ", ?";
  Statement cell(database, "INSERT INTO cell (" + cell_columns() + ") VALUES (" + marks + ")");
  int at = 0;
  for (const std::string& text :
       {stored.key(), stored.origin.machine, stored.origin.program, stored.origin.scene_sha256, setting.scene,
        sim::method_name(setting.method)})
    cell.bind_at(at++, text);
  for (const double value : setting.values) cell.bind_at(at++, value);
  cell.bind_at(at++, stored.cell.seed);
  cell.bind_at(at++, stored.cell.seconds);
  cell.bind_at(at++, stored.cell.size);
  cell.bind_at(at++, stored.cell.kept);
  cell.bind_at(at++, stored.run.particles_mean);
  cell.bind_at(at++, stored.run.substeps_mean);
  cell.bind_at(at++, stored.run.braked);
  cell.bind_at(at, stored.run.pixels_per_degree);
  const auto id = cell.run();
  Statement sample(
      database,
      fmt::format("INSERT INTO sample (cell_id, {}) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", sample_columns));
  for (const auto& s : stored.run.samples) {
    sample.bind_all(id, s.time_s, s.front_m, s.centre_m[0], s.centre_m[1], s.centre_m[2], s.kinetic_j_kg,
                    s.density_error, s.density_max);
    sample.run();
  }
  Statement frame(database, "INSERT INTO frame VALUES (?, ?, ?, ?)");
  std::int64_t number = 0;
  for (const auto& cost : stored.run.frames) {
    frame.bind_all(id, number++, cost.solve_ms, cost.draw_ms);
    frame.run();
  }
  Statement picture(database,
                    "INSERT INTO picture (cell_id, time_s, png, fovea, salient) VALUES (?, ?, ?, ?, ?)");
  for (const auto& kept : stored.run.pictures) {
    picture.bind_all(id, kept.time_s, sqlite::Blob{kept.png}, sqlite::Blob{kept.fovea},
                     sqlite::Blob{kept.salient});
    picture.run();
  }
  return true;
}

}  // namespace

SweepFile::SweepFile(const std::filesystem::path& path, Open how) {
  if (how == Open::Create) base::make_folder_of(path);
  database_ = std::make_unique<Connection>(path, how);
  recognise(*database_, how);
  try {
    database_->check_integrity();
  } catch (const sqlite::LockedOut&) {
    throw;  // the file is locked by another program, which is no damage
  } catch (const base::Error&) {
    refuse_damaged(path);
  }
  database_->execute("PRAGMA foreign_keys = ON");
  // user_version is 0 in a new file, and in a file whose first transaction was cut off by a kill: SQLite
  // rolls that transaction back before the first read.
  if (how == Open::Read && database_->integer("PRAGMA user_version") == 0) refuse(path);
  if (how == Open::Read) return;
  database_->execute("PRAGMA synchronous = FULL");
  Transaction transaction(*database_);
  if (database_->integer("PRAGMA user_version") == 0) {
    database_->execute(schema());
    database_->execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                   sweep_application_id, schema_version));
  }
  transaction.commit();
}

void SweepFile::add(const StoredCell& stored) {
  Transaction transaction(*database_);
  insert(*database_, stored);
  transaction.commit();
}

std::set<std::string> SweepFile::keys(const std::string& machine) {
  std::set<std::string> out;
  Statement rows(*database_, "SELECT key FROM cell WHERE machine = ?");
  rows.bind_all(machine);
  while (rows.step()) out.insert(rows.text(0));
  return out;
}

std::vector<StoredCell> SweepFile::cells() {
  std::vector<StoredCell> out;
  Statement rows(*database_, "SELECT id, " + cell_columns() +
                                 " FROM cell ORDER BY machine, program, scene_sha256, scene, method, " +
                                 knob_columns("") + "seconds, picture, kept, seed");
  while (rows.step()) {
    out.push_back(read_cell(rows));
    read_run(*database_, rows.integer(0), out.back().run);
  }
  return out;
}

std::int64_t SweepFile::merge(const std::filesystem::path& shard) {
  SweepFile other(shard, Open::Read);
  std::int64_t added = 0;
  Transaction transaction(*database_);
  for (const auto& cell : other.cells()) added += insert(*database_, cell);
  transaction.commit();
  return added;
}

}  // namespace study
