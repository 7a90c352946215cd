#pragma once
/// How every reader opens a study, so that none of them says more, or less, than whoever writes would.

#include <memory>
#include <string>

#include "libstudy/store/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// A database that is open for reading.
struct OpenedStudy {
  std::unique_ptr<sqlite::Connection> database;
  /// What its journal alone holds, as "3 answers and 9 other rows stand in the journal alone"; empty:
  /// nothing.
  std::string lacking;
};

/// Opens a database as open_database() does for reading, and compares it with the journal beside it.
///
/// base::Error where the journal holds more than the database: its log was lost, or a backup was put back.
/// With StudyFile::incomplete it is opened nevertheless, and `lacking` says what is not in it.
///
/// What the next opening for writing would make of the two is what a reader sees, in a temporary copy where
/// the file itself is not so: a commit that a kill cut short is in it; whoever has a tombstone in the
/// journal, or is named in a withdrawal that was not finished, is not, nor is gaze of whoever refused it
/// there. That holds for an incomplete study as well.
OpenedStudy open_study(const StudyFile& study);

/// OpenedStudy::lacking of a study, whether or not it may be incomplete.
std::string lacking_of(const std::filesystem::path& database);

}  // namespace study
