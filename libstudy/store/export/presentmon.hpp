#pragma once
/// Exports the frame times of each showing as a CSV file in the format of PresentMon, which programs for the
/// analysis of frame times read.

#include <span>
#include <string>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_folder.hpp"

namespace study {

/// Writes presentmon/showing_<presentation_id>.csv for each showing that has two frames or more whose times
/// of submission are known and ascend. Returns the number of rows of all files, under a name that says how
/// many showings they are and how many were left out.
///
/// The columns are presentmon_columns(). Other columns of PresentMon are not known. MsBetweenDisplayChange is
/// only written if the display reported the onset of each frame. Under grade D (times of submission alone),
/// and if the showing was not interrupted, the last row stands for the picture that replaced the last frame.
/// The last frame then has an interval too, as in the showing's certificate. Under the other grades the last
/// frame has no interval, because the database has no time of its end that is of the same kind as the other
/// times.
ExportedFile write_presentmon(sqlite::Connection& database, const ExportDraft& draft);

/// The columns of the files, with their meanings.
std::span<const ColumnMeaning> presentmon_columns();

/// True for the name of a file that write_presentmon() writes.
bool is_presentmon_name(const std::string& name);

}  // namespace study
