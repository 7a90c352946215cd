#pragma once
/// Part of salvage(): joins the rows of a damaged database and its journal in one database.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/salvage/page_scan.hpp"
#include "libstudy/store/salvage/salvage.hpp"

namespace study::salvaging {

using RowsByTable = std::map<std::string, std::vector<Values>>;

/// True for tables with thousands of rows per trial, which are never held in memory, and for all tables that
/// are not journalled.
bool is_large(const std::string& table);

/// Fills an empty database of the newest schema, table by table, parents first: the database's rows, then
/// those only in the journal.
class Rebuild {
 public:
  Rebuild(sqlite::Connection& target, const JournalContent& journal, Salvage& told);

  /// Takes the rows of all tables but the large ones. base::Error if database and journal are of different
  /// studies.
  void take(RowsByTable rows);
  /// Takes a row of a large table. Skips rows of missing presentations.
  void take_large(const Shape& shape, const Values& values);
  /// Counts the rows in the result and those missing from it.
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
  std::set<std::string> withdrawn_;  // persons
  bool journal_is_newer_ = true;
};

}  // namespace study::salvaging
