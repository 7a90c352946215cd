#pragma once
/// One line for each planned trial with all that an analysis of ratings needs, joined from five tables.

#include <span>
#include <string>

namespace study {

/// A column of the joined table and the schema's column that it comes from.
struct RatingColumn {
  const char* name;
  const char* table;
  const char* column;
};

std::span<const RatingColumn> rating_columns();

/// Selects them in that order, one row for each trial and question. Without an answer the score and all that
/// describes the showing are NULL.
std::string rating_table_sql();

}  // namespace study
