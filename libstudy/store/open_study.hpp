#pragma once
/// Opens a study for reading: every reader gets the data that a writer would get.

#include <functional>
#include <memory>
#include <string>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// A database that is open for reading.
struct OpenedStudy {
  std::unique_ptr<sqlite::Connection> database;
  /// How the database lags behind its journal of answers, in words: "3 answers and 9 other rows are in the
  /// journal only" or, if no row is missing, "2 answers differ from the journal"; empty: it does not.
  std::string lacking;
};

/// Opens a database for reading (open_database()) and compares it with the journal of answers beside it.
///
/// base::Error if the journal has rows that the database lacks, or other answers: the database's log was
/// lost, or a backup was restored. With StudyFile::incomplete such a database is opened, and `lacking`
/// describes the difference.
///
/// The result has the state that the next opening for writing would produce; it is a temporary copy if the
/// file differs from this state. The state includes a commit that a kill interrupted. It excludes people with
/// a tombstone in the journal or in an unfinished withdrawal. A temporary copy also excludes gaze that is
/// refused. In an incomplete study the same people and gaze are excluded; of the rows that only the journal
/// has, it includes permission changes and consent answers.
///
/// The path "service:NAME" is the central database of a lab (service_of()). It is read once in a process, by
/// the function of read_central_with(); each opening gets a temporary copy of what was read.
OpenedStudy open_study(const StudyFile& study);

/// Reads the study of the central database of a service into a temporary database.
using CentralReading = std::function<std::unique_ptr<sqlite::Connection>(const std::string& service)>;
/// Lets open_study() read central databases. A program calls it once with read_central_study()
/// (libstudy/store/remote/central_study.hpp); without it "service:NAME" is an error.
void read_central_with(CentralReading reading);

/// OpenedStudy::lacking of a database; an incomplete database is no error.
std::string lacking_of(const std::filesystem::path& database);

}  // namespace study
