#pragma once
/// The database as a BIDS data set of behaviour.

#include <filesystem>
#include <vector>

#include "libstudy/store/export_folder.hpp"

namespace study {

/// participants.tsv, sub-<code>/sub-<code>_sessions.tsv, for each session
/// sub-<code>/ses-<protocol>v<visit>/beh/..._task-<protocol>_events.tsv with a sidecar (one line for each
/// stimulus shown, onset and duration in seconds first; the answers stand at the last stimulus that they
/// judge), and phenotype/<block>.tsv with what was answered on pages, without free words. "n/a" = not known.
/// Errors and folder as export_csv().
std::vector<ExportedFile> export_bids(const std::filesystem::path& database,
                                      const std::filesystem::path& folder);

}  // namespace study
