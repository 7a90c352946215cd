#pragma once
/// Exports the database as a behavioural BIDS data set.

#include <filesystem>
#include <span>
#include <string>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// participants.tsv, sub-<code>/sub-<code>_sessions.tsv with a sidecar, for each session
/// sub-<code>/ses-<protocol>v<visit>/beh/..._task-<protocol>_events.tsv with a sidecar (one line for each
/// stimulus shown, onset and duration in seconds first; answers are in the line of the last stimulus that
/// they judge), and phenotype/<block>.tsv with the answers on pages, without free text: one line per
/// participant, columns <session>_<block>_<question> (<block>-2 and so on for a repeated page). "n/a" = not
/// known. With `gaze` also gaze: ..._recording-eye1_physio.tsv.gz of an eye tracker, ..._acq-mouse_beh.tsv of
/// the mouse. A public export: it holds only shared_sessions(). Errors and folder as export_csv().
PublicExport export_bids(const StudyFile& study, const std::filesystem::path& folder, bool gaze = false);

/// File of the self-description of a public data set, in BIDS and in Psych-DS.
inline constexpr const char* description_file = "dataset_description.json";

/// The self-description of a public data set.
struct AboutDataSet {
  std::string name;       ///< the study's protocols: "comfort 1.0, task1 1.1"
  std::string simulated;  ///< a sentence: how many participants an observer model answered for; empty: none
};
AboutDataSet about_data_set(sqlite::Connection& database, std::span<const LabelledSession> sessions);

}  // namespace study
