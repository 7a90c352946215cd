#pragma once
/// The database as CSV files (RFC 4180, UTF-8, a header line, empty = unknown) with a data dictionary. Texts
/// are formula_guarded(), which the dictionary's first line explains; numbers stay numbers.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/export_folder.hpp"
#include "libstudy/store/rating_table.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// What is written on demand alone.
struct CsvChoice {
  bool words = false;       ///< free words of participants and the experimenter's notes: words.csv, notes.csv
  bool gaze = false;        ///< gaze.csv, heads.csv, gaze_validations.csv
  CsvDialect dialect = {};  ///< excel_dialect() for spreadsheets; dictionary.csv says which was taken
};

/// Writes one file for each table, ratings.csv with one line for each planned trial and question joined from
/// them, the scores of sickness_tables(), dictionary.csv with what each column means, and the text of each
/// protocol as protocol_<hash>.toml. This is the lab's own copy: it holds everybody; sessions.csv says who
/// may stand in public exports.
///
/// Folder and files are the owner's alone.
/// All is written to a neighbour of `folder` and put in place by one rename, so that `folder` never holds a
/// part. `folder` may be absent, empty or an earlier export as it was written, which is replaced;
/// base::Error, with nothing changed, when a file was added or changed, or when the database cannot be
/// written: the folder is registered in it with whom it holds, and a withdrawal of one of them deletes it
/// (export_register.hpp).
std::vector<ExportedFile> export_csv(const StudyFile& study, const std::filesystem::path& folder,
                                     const CsvChoice& choice = {});

/// A column of the schema with the comment that stands beside it.
struct ColumnMeaning {
  std::string table, column, type, meaning;
};

/// The columns of a CREATE TABLE text in their order; lines without a comment have an empty meaning.
std::vector<ColumnMeaning> column_meanings(const std::string& table, const std::string& create_sql);

/// What a column of a joined table means, from the schema of `database`.
ColumnMeaning meaning_of(sqlite::Connection& database, const RatingColumn& column);

}  // namespace study
