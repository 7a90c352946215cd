#pragma once
/// The database as a Psych-DS data set: CSV files of one session each, and every column in the metadata.

#include <filesystem>

#include "libstudy/store/export_folder.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// data/study-<protocol>_subject-<code>_session-<protocol>v<visit>_data.csv: ratings as in ratings.csv;
/// ..._description-pages_data.csv: answers on pages, without free words. A public export: only
/// shared_sessions() are in it. Errors and folder as export_csv().
PublicExport export_psych_ds(const StudyFile& study, const std::filesystem::path& folder);

}  // namespace study
