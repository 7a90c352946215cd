#pragma once
/// Exports the database as CSV files (RFC 4180, UTF-8, a header line, empty = unknown) with a data
/// dictionary. Texts are formula_guarded(), as the dictionary's first line explains; numbers are unchanged.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/export/rating_table.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// Optional parts of the export.
struct CsvChoice {
  bool words = false;       ///< free text of participants, notes of the experimenter: words.csv, notes.csv
  bool gaze = false;        ///< gaze.csv, heads.csv, gaze_validations.csv
  CsvDialect dialect = {};  ///< excel_dialect() for spreadsheets; dictionary.csv names it
};

/// Writes one file per table, ratings.csv with one joined line per planned trial and question, the scores of
/// sickness_tables(), dictionary.csv with the meaning of each column, and the text of each protocol as
/// protocol_<hash>.toml. This is the lab's own copy with all participants; sessions.csv says who may be in
/// public exports.
///
/// Only the owner can read folder and files. All is written beside `folder` and put in place by one rename,
/// so that `folder` is never partial. `folder` may be absent, empty or an unchanged earlier export, which is
/// replaced; base::Error, with nothing changed, if a file in it was added or changed, or if the database
/// cannot be written. The database registers the folder with its participants; a withdrawal of one of them
/// deletes the folder (export_register.hpp).
std::vector<ExportedFile> export_csv(const StudyFile& study, const std::filesystem::path& folder,
                                     const CsvChoice& choice = {});

/// A column of the schema with its comment.
struct ColumnMeaning {
  std::string table, column, type, meaning;
};

/// The columns of a CREATE TABLE text in order; columns without a comment have an empty meaning.
std::vector<ColumnMeaning> column_meanings(const std::string& table, const std::string& create_sql);

/// The meaning of a column of a joined table, from the schema of `database`.
ColumnMeaning meaning_of(sqlite::Connection& database, const RatingColumn& column);

}  // namespace study
