#pragma once
/// The table of ratings: one line per planned trial and question, joined with all columns that an analysis
/// needs.

#include <span>
#include <string>

namespace study {

/// A column of the table of ratings, and the schema's column from which it comes.
struct RatingColumn {
  const char* name;
  const char* from;  ///< alias of the table in the SQL: cell and presentation are joined twice, as _1 and _2
  const char* table;
  const char* column;
  const char* expression = nullptr;  ///< SQL that replaces <from>.<column>; nullptr: none
  const char* meaning = nullptr;     ///< text that replaces the schema's comment; nullptr: none
  const char* type = "INTEGER";      ///< SQL type of the expression
};

std::span<const RatingColumn> rating_columns();

/// Meanings of a showing's columns `counts` and `why_not`, as every export describes them.
inline constexpr const char* showing_counts_meaning =
    "1: an answer that counts is about this showing, 0: why_not says why none is";
inline constexpr const char* showing_why_not_meaning =
    "set aside (to be shown again), cut short, shown again (after an interruption), not answered, excluded "
    "(by "
    "the experimenter) or practice; empty: the showing counts";
/// Meanings of a showing's columns `active_fraction` and `tau_fps`, as every export describes them.
inline constexpr const char* showing_active_meaning =
    "share of particles that the solver solved, mean over the frames; empty: not measured, or a method that "
    "solves all";
inline constexpr const char* showing_tau_meaning =
    "tau that the solver went by, mean over the frames, frames/s; empty: not measured, or a method without "
    "tau";

/// Words to put before a column's meaning: "first or only stimulus: " or "second stimulus of a pair: "; empty
/// if the column is about neither.
std::string rating_subject(const RatingColumn& column);

/// SQL that selects rating_columns() in order, one row per trial and question. The schema's view `judgement`
/// selects the answer and the showing. condition: SQL that selects rows, e.g. "session.session_id = 3".
std::string rating_table_sql(const std::string& condition = "1");

}  // namespace study
