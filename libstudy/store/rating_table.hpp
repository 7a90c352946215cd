#pragma once
/// One line for each planned trial and question with all that an analysis of ratings needs.

#include <span>
#include <string>

namespace study {

/// A column of the joined table and the schema's column that it comes from.
struct RatingColumn {
  const char* name;
  const char* from;  ///< name of the table in the statement; cells and presentations stand there twice
  const char* table;
  const char* column;
  const char* expression = nullptr;  ///< instead of from.column
  const char* meaning = nullptr;     ///< instead of what the schema says of the column
};

std::span<const RatingColumn> rating_columns();

/// Which stimulus a column tells of, in words before its meaning; empty: none in particular.
std::string rating_subject(const RatingColumn& column);

/// Selects them in that order, one row for each trial and question. Without an answer the score and all that
/// describes the showing are NULL; of several answers the last one counts.
/// `condition` (such as "session.session_id = 3") leaves out the others.
std::string rating_table_sql(const std::string& condition = "1");

}  // namespace study
