#pragma once
/// Exports the database as a behavioural BIDS data set.

#include <filesystem>
#include <span>
#include <string>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// Writes a public export, which contains only shared_sessions(), into `folder`; the umask decides who can
/// read it. `folder` may be absent, empty or an unchanged earlier BIDS export, which is replaced.
/// base::Error, with the folder unchanged, if it has added or changed files, or if the database cannot be
/// written, which must register the export. The value "n/a" means not known. Each table except the motion
/// recording's channels has a JSON description. The files, besides README.md, dataset_description.json and
/// those in the folder code:
/// - participants.tsv, and sub-<code>/sub-<code>_sessions.tsv.
/// - sub-<code>/ses-<protocol>v<visit>/beh/..._task-<protocol>_events.tsv for each session: one line per
///   stimulus shown, beginning with onset and duration in seconds. The line of a trial's last stimulus has
///   the answers about the trial.
/// - phenotype/<block>.tsv: answers on pages, without free text. One line per participant, with columns
///   <session>_<block>_<question>; the block of a repeated page is <block>-2 and so on.
///   SSQ and FMS pages are in ssq.tsv and fms.tsv instead, and fms_summary.tsv has mean and peak of the FMS.
/// - With `gaze` true, for sessions that allow gaze: ..._recording-eye1_physio.tsv.gz of an eye tracker,
///   ..._acq-mouse_beh.tsv of a mouse, ..._acq-head_beh.tsv of the head's direction, and head poses as a
///   motion recording.
PublicExport export_bids(const StudyFile& study, const std::filesystem::path& folder, bool gaze = false);

/// Name of the file that describes a public data set, in BIDS and in Psych-DS.
inline constexpr const char* description_file = "dataset_description.json";

/// Texts for the description of a public data set.
struct AboutDataSet {
  std::string name;       ///< names and versions of the protocols: "comfort 1.0, task1 1.1"
  std::string simulated;  ///< sentence with the number of simulated participants; empty: there are none
  std::string imported;   ///< sentences with the numbers of imported sessions; empty: there are none
};
AboutDataSet about_data_set(sqlite::Connection& database, std::span<const LabelledSession> sessions);

}  // namespace study
