#pragma once
/// Exports the database as a Psych-DS data set: CSV files for each session, and metadata with the meaning of
/// every column.

#include <filesystem>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// Writes a public export, which contains only shared_sessions(), into `folder`. Folder and base::Error as
/// for export_csv(), but the umask decides who can read the files. The files for each session, besides
/// README.md, dataset_description.json and materials/setting_*:
/// - data/study-<protocol>_subject-<code>_session-<protocol>v<visit>_data.csv: the session's rows of the
///   table of ratings (rating_table.hpp).
/// - ..._description-pages_data.csv: answers on pages, without free text.
/// - ..._description-<table>_data.csv: each table of sickness_tables() that has rows.
PublicExport export_psych_ds(const StudyFile& study, const std::filesystem::path& folder);

}  // namespace study
