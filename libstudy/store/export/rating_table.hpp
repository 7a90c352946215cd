#pragma once
/// The table of ratings: one line per planned trial and question, joined with all columns that an analysis
/// needs.

#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// A column of the table of ratings, and the schema's column from which it comes.
struct RatingColumn {
  std::string name;
  std::string from;  ///< alias of the table in the SQL, such as cell_1 for the cell of the first stimulus
  std::string table;
  std::string column;
  std::string expression = {};   ///< SQL that replaces <from>.<column>; empty: none
  std::string meaning = {};      ///< text that replaces the schema's comment; empty: none
  std::string type = "INTEGER";  ///< SQL type of the expression
};

/// A factor of the design (protocol files of format 3 can name factors), as a column of an export.
struct FactorColumn {
  /// Name of the column: the letters, digits and '_' of the factor's name ("factor" if it has none), followed
  /// by "_level" while another column has this name.
  std::string name;
  std::string factor;  ///< name in the database
  std::string meaning;

  /// SQL for the name of the level of a cell; `cell`: alias of the table cell.
  std::string level_sql(const std::string& cell) const;
};

/// The factors of the protocols of all sessions that the SQL condition selects, such as "session.visit = 1",
/// in the order of their protocols; empty: no protocol has factors. taken: names that no column may have.
std::vector<FactorColumn> factor_columns(sqlite::Connection& database, const std::string& condition,
                                         std::set<std::string> taken);

/// The columns of the table of ratings for the sessions that the SQL condition selects. If a protocol of
/// these sessions has factors, also the columns of their levels, the timing profile, p99_ms, hitches and
/// animation_error_ms.
std::vector<RatingColumn> rating_columns(sqlite::Connection& database, const std::string& condition = "1");

/// Meanings of a showing's columns `counts` and `why_not` in the descriptions of exports.
inline constexpr const char* showing_counts_meaning =
    "1: an answer that counts is about this showing, 0: why_not says why none is";
inline constexpr const char* showing_why_not_meaning =
    "set aside (to be shown again), cut short, shown again (after an interruption), not answered, excluded "
    "(by "
    "the experimenter) or practice; empty: the showing counts";
/// Meaning of a showing's grade of evidence in the descriptions of exports.
inline constexpr const char* showing_grade_meaning =
    "evidence: A photodiode, B display, C compositor, D submit; raised by the log of a light sensor "
    "(light.csv); "
    "empty: no frames were recorded";
/// Meanings of a showing's columns `active_fraction` and `tau_fps` in the descriptions of exports.
inline constexpr const char* showing_active_meaning =
    "share of particles that the solver solved, mean over the frames; empty: not measured, or a method that "
    "solves all";
inline constexpr const char* showing_tau_meaning =
    "tau that the solver went by, mean over the frames, frames/s; empty: not measured, or a method without "
    "tau";

/// Words to put before a column's meaning: "first or only stimulus: " or "second stimulus of a pair: "; empty
/// if the column is about neither.
std::string rating_subject(const RatingColumn& column);

/// SQL that selects rating_columns() in order, one row per trial and question. If a trial was shown or a
/// question answered several times, the schema's view `judgement` selects the last answer that was not set
/// aside, and its showing. condition: SQL that selects sessions, e.g. "session.session_id = 3".
std::string rating_table_sql(sqlite::Connection& database, const std::string& condition = "1");

}  // namespace study
