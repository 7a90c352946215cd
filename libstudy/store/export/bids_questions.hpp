#pragma once
/// Parts of export_bids(): questions as columns, and the pages of questionnaires.

#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/export/bids_writer.hpp"

namespace study::bids {

/// A question as a column.
struct Item {
  std::int64_t id = 0;
  std::string code, wording, anchors;
};

/// Describes the column, including the words at its scores.
Json question_column(const Item& item);
/// Questions with scores asked in trials or on pages of a block; `of`: SQL condition on unit u.
std::vector<Item> items(sqlite::Connection& database, std::int64_t session, const std::string& of);
/// Score and response time of a question at a showing (`attempt`).
std::pair<std::string, std::string> answer_of(sqlite::Connection& database, std::int64_t unit,
                                              std::int64_t question, std::int64_t attempt);

/// Writes the pages as phenotype tables: SSQ with its scores and FMS with mean and peak by kind, other pages
/// by block.
void write_phenotypes(sqlite::Connection& database, const std::vector<LabelledSession>& sessions,
                      Writer& writer);

}  // namespace study::bids
