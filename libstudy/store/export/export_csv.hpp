#pragma once
/// Exports the database as CSV files (RFC 4180, UTF-8, with a header line) and a data dictionary. An empty
/// field means unknown. A text that a spreadsheet would read as a formula gets an apostrophe
/// (formula_guarded()), as the dictionary's first line explains.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/export/rating_table.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// Optional parts and format of the export.
struct CsvChoice {
  bool words = false;       ///< words.csv: participants' free text; notes.csv: the experimenter's notes
  bool gaze = false;        ///< gaze.csv, heads.csv, gaze_validations.csv
  bool presentmon = false;  ///< write_presentmon() (presentmon.hpp)
  CsvDialect dialect = {};  ///< excel_dialect() for spreadsheets, which dictionary.csv then describes
};

/// Writes an export with all participants, for the lab itself, into `folder`. Column sharing_allowed of
/// sessions.csv records who may be in public exports. The files: one for each table with study data that
/// `choice` includes; ratings.csv with one line per planned trial and question; the tables of
/// sickness_tables(); dictionary.csv with the meaning of each column; each protocol's text as
/// protocol_<hash>.toml; each solver setting's file (setting_file_name()); export.sha256 with the SHA-256 of
/// each of these files.
///
/// Only the owner can read folder and files. The export is written beside `folder` and renamed to it at the
/// end, so that `folder` is never partial. `folder` may be absent, empty or an unchanged earlier export,
/// which is replaced. base::Error, with nothing changed, if the folder has added or changed files, or if the
/// database cannot be written. The database registers the folder with its participants: if one of them
/// withdraws, the withdrawal deletes the folder (export_register.hpp).
std::vector<ExportedFile> export_csv(const StudyFile& study, const std::filesystem::path& folder,
                                     const CsvChoice& choice = {});

/// A column of a table, with its meaning from the comment in the schema.
struct ColumnMeaning {
  std::string table, column, type, meaning;
};

/// The columns of the table that the SQL text `create_sql` (CREATE TABLE) defines, in order. A column without
/// a comment has an empty meaning.
std::vector<ColumnMeaning> column_meanings(const std::string& table, const std::string& create_sql);

/// The meaning of a column of the table of ratings, from the schema of `database` if RatingColumn has none.
ColumnMeaning meaning_of(sqlite::Connection& database, const RatingColumn& column);

}  // namespace study
