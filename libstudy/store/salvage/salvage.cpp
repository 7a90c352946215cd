#include "libstudy/store/salvage/salvage.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/foreign_log.hpp"
#include "libstudy/store/file/page_file.hpp"
#include "libstudy/store/file/schema.hpp"
#include "libstudy/store/file/writer_lock.hpp"
#include "libstudy/store/refusals.hpp"
#include "libstudy/store/salvage/page_scan.hpp"
#include "libstudy/store/salvage/salvage_rows.hpp"
#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"

namespace study {

namespace fs = std::filesystem;
using salvaging::RowsByTable;
using salvaging::Shape;
using salvaging::Values;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;

namespace {

/// The layout of a table in an earlier schema, and how its rows convert to the current schema.
struct EarlierShape {
  Shape shape;
  std::size_t now = 0;  ///< index of the table's current shape
  /// For each current column: index of the earlier column that is copied to it; none: the column becomes
  /// NULL.
  std::vector<std::optional<std::size_t>> source;
};

constexpr std::size_t first_schema = 2;

bool same(const Shape::Column& a, const Shape::Column& b) {
  return a.name == b.name && a.type == b.type && a.may_be_null == b.may_be_null;
}

bool same(const Shape& a, const Shape& b) {
  return a.table == b.table &&
         std::equal(a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end(),
                    [](const auto& x, const auto& y) { return same(x, y); });
}

/// True if the upgrade of a schema keeps the values of a column. It keeps those of a column that lost its NOT
/// NULL, but for the share of solved particles, which schemas before 4 made up.
bool is_kept(const Shape& earlier, const Shape::Column& before, const Shape::Column& now) {
  if (same(before, now)) return true;
  return before.name == now.name && before.type == now.type && now.may_be_null &&
         !(earlier.table == "frame" && before.name == "active_fraction");
}

EarlierShape placed(const Shape& shape, const std::vector<Shape>& now, std::size_t index) {
  EarlierShape out{shape, index, {}};
  for (const Shape::Column& column : now[index].columns) {
    const auto found =
        std::find_if(shape.columns.begin(), shape.columns.end(),
                     [&](const Shape::Column& before) { return is_kept(shape, before, column); });
    out.source.emplace_back();
    if (found != shape.columns.end())
      out.source.back() = static_cast<std::size_t>(found - shape.columns.begin());
  }
  return out;
}

/// The shapes of all tables in every earlier schema, from schema 2 on.
std::vector<Shape> shapes_before() {
  std::vector<Shape> out;
  const SchemaSteps steps = read_schema_steps();
  const auto database = make_temporary_database("earlier schemas", {});
  for (std::size_t schema = first_schema; schema < steps.size(); ++schema) {
    upgrade(*database, {steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(schema)});
    for (Shape& shape : salvaging::shapes_of(*database)) out.push_back(std::move(shape));
  }
  return out;
}

/// The earlier shapes, from schema 2 on, that differ from the tables' current shapes `now`. A column is
/// copied if the upgrade keeps its values (is_kept()). Every other current column becomes NULL.
std::vector<EarlierShape> earlier_shapes(const std::vector<Shape>& now) {
  static const std::vector<Shape> before = shapes_before();
  std::vector<EarlierShape> out;
  for (const Shape& shape : before) {
    const auto table =
        std::find_if(now.begin(), now.end(), [&](const Shape& one) { return one.table == shape.table; });
    const bool known =
        table == now.end() || same(*table, shape) ||
        std::any_of(out.begin(), out.end(), [&](const EarlierShape& one) { return same(one.shape, shape); });
    if (!known) out.push_back(placed(shape, now, static_cast<std::size_t>(table - now.begin())));
  }
  return out;
}

Values as_now(const EarlierShape& earlier, const Values& row) {
  Values out;
  for (const auto& column : earlier.source) out.push_back(column ? row.at(*column) : salvaging::Value());
  return out;
}

/// A temporary folder beside the new database that only its owner can read. The destructor deletes it.
class Workplace {
 public:
  explicit Workplace(const fs::path& into) : path_(into.string() + ".salvage-XXXXXX") {
    base::make_folder_of(into);
    if (!::mkdtemp(path_.data())) {
      throw base::Error(into.string(), std::string("cannot be made: ") + std::strerror(errno),
                        "name a file in a folder that you may write to");
    }
  }
  ~Workplace() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;
  fs::path operator/(const char* name) const { return fs::path(path_) / name; }

 private:
  std::string path_;
};

void refuse(const fs::path& into) {
  for (const fs::path& path : {into, journal_beside(into), fs::path(into.string() + "-wal")}) {
    std::error_code ignored;
    if (fs::symlink_status(path, ignored).type() != fs::file_type::not_found)
      throw base::Error(path.string(), "exists", "name a new file for --into");
  }
}

void copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::is_regular_file(from, error)) return;
  fs::copy_file(from, to, error);
  if (error)
    throw base::Error(from.string(), "cannot be copied: " + error.message(),
                      "check the disk and its free space");
}

/// Locks the damaged file while it is read, if it exists and is writable. Without the lock, another vip-study
/// could write meanwhile, and the result would mix two states.
std::unique_ptr<WriterLock> lock_out_writers(const fs::path& database) {
  std::error_code ignored;
  if (!fs::is_regular_file(database, ignored) || ::access(database.c_str(), W_OK) != 0) return {};
  return std::make_unique<WriterLock>(database);
}

/// Reads a copy of a database that has tables, columns, views or triggers that are not from vip-study.
/// Returns a temporary database with the parts that are from vip-study, upgraded to the newest schema. Adds
/// descriptions of all other parts to `left_out`.
std::unique_ptr<Connection> open_without_foreign_parts(const fs::path& copied,
                                                       std::vector<std::string>& left_out) {
  Connection foreign(copied, Open::Write);
  foreign.distrust(sqlite::Work::Any);
  const SchemaSteps steps = read_schema_steps();
  auto own = without_foreign_parts(foreign, steps, foreign.integer("PRAGMA user_version"), left_out);
  upgrade(*own, steps);
  return own;
}

/// Copies the database to `copied` and opens the copy with SQLite; null if SQLite cannot open it, if it is
/// damaged, or if a row refers to a missing row.
std::unique_ptr<Connection> open_sound(const fs::path& database, const fs::path& copied, bool use_log,
                                       std::vector<std::string>& left_out) {
  for (const std::string beside : {"", "-wal", "-journal"})
    if (use_log || beside.empty()) copy(database.string() + beside, copied.string() + beside);
  std::vector<std::string> parts;
  try {
    std::unique_ptr<Connection> sound;
    try {
      sound = open_database(copied, Open::Write, read_schema_steps());
    } catch (const ForeignSchema&) {
      sound = open_without_foreign_parts(copied, parts);
    }
    if (Statement lost(*sound, "PRAGMA foreign_key_check"); lost.step()) return {};
    left_out.insert(left_out.end(), parts.begin(), parts.end());
    return sound;
  } catch (const base::Error&) {
    return {};
  }
}

/// Returns false, and adds the file to told.left_out, if the log or journal beside the database belongs to
/// another database.
bool may_use_log(const fs::path& database, Salvage& told) {
  const auto foreign =
      foreign_log(database, [&] { return salvaging::File(database).read(0, salvaging::header_bytes); });
  if (foreign) told.left_out.push_back(foreign->file.filename().string() + ", which " + foreign->problem);
  return !foreign;
}

using Take = std::function<void(const Shape&, Values)>;

void read_sound(Connection& database, const std::vector<Shape>& shapes, bool large, const Take& take) {
  for (const Shape& shape : shapes) {
    if (salvaging::is_large(shape.table) != large) continue;
    for (Statement row(database, "SELECT * FROM " + shape.table); row.step();) {
      Values values(shape.columns.size());
      for (int i = 0; i < row.columns(); ++i) {
        auto& value = values[static_cast<std::size_t>(i)];
        if (row.is_text(i))
          value = row.text(i);
        else if (row.is_real(i))
          value = row.real(i);
        else if (!row.is_null(i))
          value = row.integer(i);
      }
      take(shape, std::move(values));
    }
  }
}

/// The damaged database to read page by page. use_log: also read its log.
struct Damaged {
  const fs::path& database;
  bool use_log;
};

/// Calls `take` for the rows of the large tables (`large` true: frames, slots, head poses, gaze,
/// validations, markers, clocks of eye trackers, light), or of all other tables. Reads from `sound`, or page
/// by page if `sound` is null.
void read_rows(Connection* sound, const Damaged& damaged, const std::vector<Shape>& shapes,
               const std::vector<EarlierShape>& earlier, bool large, const Take& take) {
  if (sound) return read_sound(*sound, shapes, large, take);
  std::vector<Shape> all = shapes;
  for (const auto& one : earlier) all.push_back(one.shape);
  const auto take_row = [&](const Shape& shape, Values values) {
    if (salvaging::is_large(shape.table) != large) return;
    const auto index = static_cast<std::size_t>(&shape - all.data());
    if (index < shapes.size()) return take(shape, std::move(values));
    const auto& before = earlier[index - shapes.size()];
    take(shapes[before.now], as_now(before, values));
  };
  salvaging::scan_pages(damaged.database, all, take_row, damaged.use_log);
}

void fill(Connection& target, Connection* sound, const Damaged& damaged, const JournalContent& journal,
          Salvage& told) {
  sqlite::Transaction transaction(target);
  const auto shapes = salvaging::shapes_of(target);
  const auto earlier = sound ? std::vector<EarlierShape>() : earlier_shapes(shapes);
  RowsByTable rows;
  read_rows(sound, damaged, shapes, earlier, false,
            [&](const Shape& shape, Values values) { rows[shape.table].push_back(std::move(values)); });
  salvaging::Rebuild rebuild(target, journal, told);
  rebuild.take(std::move(rows));
  read_rows(sound, damaged, shapes, earlier, true,
            [&](const Shape& shape, const Values& values) { rebuild.take_large(shape, values); });
  drop_unallowed_gaze(target);  // pages of the damaged file may contain gaze from before a refusal
  rebuild.sum_up();
  Statement(target, "INSERT INTO event (utc, kind, detail) VALUES (?, 'salvaged', ?)")
      .bind_all(base::utc_now(), std::to_string(told.answers_database) + " answers from the database, " +
                                     std::to_string(told.answers_journal) + " from its journal alone")
      .run();
  transaction.commit();
}

void check(Connection& made, const fs::path& database) {
  std::string found = made.text("PRAGMA integrity_check(1)");
  Statement lost(made, "PRAGMA foreign_key_check");
  if (found == "ok" && !lost.step()) return;
  if (found == "ok") found = "a row of " + lost.text(0) + " refers to a missing row of " + lost.text(2);
  throw base::Error(
      database.string(),
      "cannot be rebuilt: the new file failed SQLite's check and was deleted (" + found + ")",
      "restore a backup of the database, and report this with its file and its journal of answers");
}

/// Copies the log into the database file and removes the log, because only the file becomes the result.
/// Closing the database would do the same, but would not report a failure.
void leave_no_log(Connection& made, const fs::path& into) {
  made.unwatch();
  if (made.text("PRAGMA journal_mode = DELETE") == "delete") return;
  throw base::Error(into.string(), "cannot be written: the log of the rebuilt data cannot be copied into it",
                    "free space on the disk, and run the command again");
}

/// Gives the finished file the path `into`. Uses link(), which fails if `into` exists.
void put_in_place(const fs::path& made, const fs::path& into) {
  if (::chmod(made.c_str(), 0600) == 0 && ::link(made.c_str(), into.c_str()) == 0)
    return base::sync_folder_of(into);
  throw base::Error(into.string(), std::string("cannot be put in place: ") + std::strerror(errno),
                    "name a new file for --into, on a disk with free space");
}

}  // namespace

Salvage salvage(const fs::path& database, const fs::path& into) {
  refuse(into);
  const auto lock = lock_out_writers(database);
  const JournalContent journal = read_journal(journal_beside(database));
  const Workplace workplace(into);
  Salvage told;
  const Damaged damaged{database, may_use_log(database, told)};
  const auto sound = open_sound(database, workplace / "copy.db", damaged.use_log, told.left_out);
  told.sound = sound != nullptr;
  told.journal = journal.exists;
  told.unreadable = journal.unreadable;
  const fs::path made = workplace / "made.db";
  {
    const auto target = open_database(made, Open::Create, read_schema_steps());
    fill(*target, sound.get(), damaged, journal, told);
    if (told.sessions == 0 && told.withdrawn.empty()) {
      throw base::Error(database.string(),
                        "nothing of a study was found in it" +
                            std::string(journal.exists ? ", nor in its journal of answers"
                                                       : ", and there is no journal of answers beside it"),
                        "restore a backup of it or of " + journal_beside(database).string() +
                            ", from which a lost database can be rebuilt");
    }
    check(*target, database);
    leave_no_log(*target, into);
  }
  put_in_place(made, into);
  const auto finished = open_database(into, Open::Write, read_schema_steps());
  rewrite_journal(*finished);
  return told;
}

}  // namespace study
