#pragma once
/// The scores of read_sickness() as export tables: ssq.csv with one line per page, fms.csv with one per
/// answer, fms_summary.csv with mean and peak of each session and of its blocks.

#include <span>
#include <string>
#include <vector>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/read/sickness.hpp"

namespace study {

/// A column with its meaning for the dictionary; SQL type.
struct SicknessColumn {
  std::string name, type, meaning;
};

struct SicknessTable {
  std::string name;  ///< "ssq", "fms", "fms_summary"
  std::vector<SicknessColumn> columns;
  std::vector<std::vector<std::string>> rows;  ///< not quoted; empty: not known
};

/// All three, in that order; a table may have no rows.
std::vector<SicknessTable> sickness_tables(std::span<const SicknessSession> sessions);
/// The table "fms_summary". After the columns of the session: block, number of answers, mean, peak.
SicknessTable fms_summary_table(std::span<const SicknessSession> sessions);

/// The scores of a page in the order of stats::ssq_scales: columns, and values as text.
std::vector<SicknessColumn> ssq_score_columns();
std::vector<std::string> ssq_texts(const stats::SsqAnswers& answers);

/// Writes a table as write_csv() does; returns its number of rows.
std::int64_t write_sickness(const SicknessTable& table, const ExportDraft& draft, const std::string& name);

}  // namespace study
