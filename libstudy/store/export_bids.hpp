#pragma once
/// The database as a BIDS data set of behaviour.

#include <filesystem>
#include <span>
#include <string>

#include "libstudy/store/export_folder.hpp"
#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// participants.tsv, sub-<code>/sub-<code>_sessions.tsv with a sidecar, for each session
/// sub-<code>/ses-<protocol>v<visit>/beh/..._task-<protocol>_events.tsv with a sidecar (one line for each
/// stimulus shown, onset and duration in seconds first; the answers stand at the last stimulus that they
/// judge), and phenotype/<block>.tsv with what was answered on pages, without free words: one line a
/// participant, columns <session>_<block>_<question> (<block>-2 and so on where a page
/// came again). "n/a" = not
/// known. With `gaze` also where people looked: ..._recording-eye1_physio.tsv.gz of an eye tracker,
/// ..._acq-mouse_beh.tsv of the mouse. A public export: only shared_sessions() are in it. Errors and folder
/// as export_csv().
PublicExport export_bids(const StudyFile& study, const std::filesystem::path& folder, bool gaze = false);

/// What a public data set says of itself.
struct AboutDataSet {
  std::string name;       ///< of the study's protocols: "comfort 1.0, task1 1.1"
  std::string simulated;  ///< a sentence: how many participants an observer model answered for; empty: none
};
AboutDataSet about_data_set(sqlite::Connection& database, std::span<const LabelledSession> sessions);

}  // namespace study
