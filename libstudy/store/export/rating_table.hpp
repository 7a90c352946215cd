#pragma once
/// The table of ratings: one line per planned trial and question, with all columns for an analysis.

#include <span>
#include <string>

namespace study {

/// A column of the joined table and the schema's column that it comes from.
struct RatingColumn {
  const char* name;
  const char* from;  ///< alias of the table in the statement, which joins cells and presentations twice
  const char* table;
  const char* column;
  const char* expression = nullptr;  ///< instead of from.column
  const char* meaning = nullptr;     ///< instead of the schema's comment
  const char* type = "INTEGER";      ///< of the expression
};

std::span<const RatingColumn> rating_columns();

/// Meanings of the columns counts and why_not of a showing in every export.
inline constexpr const char* showing_counts_meaning =
    "1: an answer that counts is about this showing, 0: why_not says why none is";
inline constexpr const char* showing_why_not_meaning =
    "set aside (to be shown again), cut short, shown again (after an interruption), not answered, excluded "
    "(by "
    "the experimenter) or practice; empty: the showing counts";
/// Meanings of the columns active_fraction and tau_fps.
inline constexpr const char* showing_active_meaning =
    "share of particles that the solver solved, mean over the frames; empty: not measured, or a method that "
    "solves all";
inline constexpr const char* showing_tau_meaning =
    "tau that the solver went by, mean over the frames, frames/s; empty: not measured, or a method without "
    "tau";

/// The stimulus that a column is about, as words before its meaning; empty: none in particular.
std::string rating_subject(const RatingColumn& column);

/// SQL that selects rating_columns() in order, one row per trial and question, with the answer and showing of
/// the schema's view judgement. `condition` filters, e.g. "session.session_id = 3".
std::string rating_table_sql(const std::string& condition = "1");

}  // namespace study
