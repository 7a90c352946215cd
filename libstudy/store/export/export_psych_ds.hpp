#pragma once
/// Exports the database as a Psych-DS data set: one CSV file per session, with every column in the metadata.

#include <filesystem>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// data/study-<protocol>_subject-<code>_session-<protocol>v<visit>_data.csv: ratings as in ratings.csv;
/// ..._description-pages_data.csv: answers on pages, without free text. A public export: it holds only
/// shared_sessions(). Errors and folder as export_csv().
PublicExport export_psych_ds(const StudyFile& study, const std::filesystem::path& folder);

}  // namespace study
