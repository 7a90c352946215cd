#pragma once
/// Parts of export_bids(): what was asked, as columns, and the pages of questionnaires.

#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/bids_writer.hpp"

namespace study::bids {

/// A question as a column.
struct Item {
  std::int64_t id = 0;
  std::string code, wording, anchors;
};

/// With the words that stand at its scores.
Json question_column(const Item& item);
/// Questions with scores that are asked at trials, or on pages of a block; `of`: a condition on unit u.
std::vector<Item> items(sqlite::Connection& database, std::int64_t session, const std::string& of);
/// Score and response time of a question at a showing.
std::pair<std::string, std::string> answer_of(sqlite::Connection& database, std::int64_t unit,
                                              std::int64_t question, std::int64_t attempt);

/// The scales by their kind, SSQ with its scores, other pages by their block; FMS also with mean and peak.
void write_phenotypes(sqlite::Connection& database, const std::vector<LabelledSession>& sessions,
                      Writer& writer);

}  // namespace study::bids
