#pragma once
/// The step of salvage() that writes the rows of a damaged database and of its journal into a new database.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/salvage/page_scan.hpp"
#include "libstudy/store/salvage/salvage.hpp"

namespace study::salvaging {

using RowsByTable = std::map<std::string, std::vector<Values>>;

/// True for frame, slot, head, gaze and gaze_validation. These tables are not in the journal; most have many
/// rows per presentation, so their rows are copied one by one instead of being loaded into memory.
bool is_large(const std::string& table);

/// Fills an empty database of the newest schema table by table, parents first. For each table, inserts the
/// damaged database's rows, then the rows that only the journal contains.
class Rebuild {
 public:
  Rebuild(sqlite::Connection& target, const JournalContent& journal, Salvage& told);

  /// Inserts the rows of all tables that are not large (is_large()), and the rows of the journal. base::Error
  /// if database and journal belong to different studies.
  void take(RowsByTable rows);
  /// Inserts a row of a large table; omits and counts a row whose parent row is missing.
  void take_large(const Shape& shape, const Values& values);
  /// Counts the sessions and frames in the result, and the answers and frames that are missing in it. Lists
  /// the people who withdrew.
  void sum_up();

 private:
  void take_table(const Shape& shape, std::vector<Values> rows);
  void take_journal(const journal::Table& table, const JournalRows& rows, bool under_way);
  void take_known(const journal::Row& row, const journal::Row& now);
  bool withdrew(const std::string& person) { return withdrawn_.contains(person); }
  void complete_plans(bool units);
  enum class Inserted { Yes, There, NoParent };
  Inserted insert(const Shape& shape, const Values& values);
  const Shape& shape_of(const std::string& table) const;

  sqlite::Connection& target_;
  const JournalContent& journal_;
  Salvage& told_;
  std::vector<Shape> shapes_;
  std::map<std::string, sqlite::Statement> inserts_;
  std::set<std::string> withdrawn_;  // session.person of people who withdrew
  bool journal_is_newer_ = true;
};

}  // namespace study::salvaging
