#pragma once
/// Exports the database as a Psych-DS data set: CSV files for each session, and metadata with the meaning of
/// every column.

#include <filesystem>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// Writes a public export, which contains only shared_sessions(), into `folder`; the umask decides who can
/// read it. `folder` may be absent, empty or an unchanged earlier Psych-DS export, which is replaced.
/// base::Error, with the folder unchanged, if it has added or changed files, or if the database cannot be
/// written, which must register the export. README.md, dataset_description.json and the folder materials
/// describe the whole data set. The files for each session:
/// - data/study-<protocol>_subject-<code>_session-<protocol>v<visit>_data.csv: the session's rows of the
///   table of ratings (rating_table.hpp).
/// - ..._description-pages_data.csv: answers on pages, without free text.
/// - ..._description-<table>_data.csv: each table of sickness_tables() that has rows; <table> is its name
///   without '_'.
PublicExport export_psych_ds(const StudyFile& study, const std::filesystem::path& folder);

}  // namespace study
