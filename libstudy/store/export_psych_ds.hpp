#pragma once
/// The database as a Psych-DS data set: CSV files of one session each, and every column in the metadata.

#include <filesystem>
#include <vector>

#include "libstudy/store/export_folder.hpp"

namespace study {

/// data/study-<protocol>_subject-<code>_session-<protocol>v<visit>_data.csv: ratings as in ratings.csv;
/// ..._description-pages_data.csv: answers on pages, without free words. Errors and folder as export_csv().
std::vector<ExportedFile> export_psych_ds(const std::filesystem::path& database,
                                          const std::filesystem::path& folder);

}  // namespace study
