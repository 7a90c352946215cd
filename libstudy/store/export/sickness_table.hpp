#pragma once
/// The sickness data of read_sickness() as tables for exports: "ssq" with one line per page, "fms" with one
/// line per answer, "fms_summary" with mean and peak of each session and of each block.

#include <span>
#include <string>
#include <vector>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/read/sickness.hpp"

namespace study {

/// A column with its SQL type and its meaning for the data dictionary.
struct SicknessColumn {
  std::string name, type, meaning;
};

struct SicknessTable {
  std::string name;  ///< "ssq", "fms" or "fms_summary"
  std::vector<SicknessColumn> columns;
  std::vector<std::vector<std::string>> rows;  ///< fields without CSV quotes; empty field: not known
};

/// The tables "ssq", "fms" and "fms_summary", in this order; a table may have no rows.
std::vector<SicknessTable> sickness_tables(std::span<const SicknessSession> sessions);
/// The table "fms_summary". Its last four columns are block, number of answers, mean and peak; the columns
/// before identify the session.
SicknessTable fms_summary_table(std::span<const SicknessSession> sessions);

/// Columns for the SSQ scores (ssq_score_columns), and a page's scores as text (ssq_texts), both in the order
/// of stats::ssq_scales.
std::vector<SicknessColumn> ssq_score_columns();
std::vector<std::string> ssq_texts(const stats::SsqAnswers& answers);

/// Writes a table as a CSV file of a draft, in the format of write_csv(); returns the number of rows.
std::int64_t write_sickness(const SicknessTable& table, const ExportDraft& draft, const std::string& name);

}  // namespace study
