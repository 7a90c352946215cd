#pragma once
/// Part of salvage(): rows of a damaged database and of its journal as one database.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/journal_file.hpp"
#include "libstudy/store/page_scan.hpp"
#include "libstudy/store/salvage.hpp"

namespace study::salvaging {

using RowsByTable = std::map<std::string, std::vector<Values>>;

/// Tables with rows by the thousand for each trial, never held in memory, and all that the journal does not
/// follow.
bool is_large(const std::string& table);

/// Fills an empty database of the newest schema, table by table, parents first: what stands in the database,
/// then what stands in the journal alone.
class Rebuild {
 public:
  Rebuild(sqlite::Connection& target, const JournalContent& journal, Salvage& told);

  /// All tables but the large ones. base::Error when database and journal are of different studies.
  void take(RowsByTable rows);
  /// A row of a large table. Those of presentations that are gone are left out.
  void take_large(const Shape& shape, const Values& values);
  /// Counts what stands in the result and what is missing from it.
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
