#pragma once
/// Opens a study for reading, so that every reader sees the same data as a writer would.

#include <memory>
#include <string>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// A database that is open for reading.
struct OpenedStudy {
  std::unique_ptr<sqlite::Connection> database;
  /// Rows that only its journal holds: "3 answers and 9 other rows stand in the journal alone"; empty: none.
  std::string lacking;
};

/// Opens a database as open_database() does for reading, and compares it with the journal beside it.
///
/// base::Error if the journal holds more than the database: its log was lost, or a backup was restored. With
/// StudyFile::incomplete it is opened nevertheless, and `lacking` says what is missing.
///
/// A reader sees the state that the next opening for writing would produce, in a temporary copy if the file
/// differs. That state has a commit that a kill interrupted, but no people with a tombstone in the journal or
/// in an unfinished withdrawal, and no gaze that is refused. The same holds for an incomplete study.
OpenedStudy open_study(const StudyFile& study);

/// OpenedStudy::lacking of a study; does not fail for an incomplete one.
std::string lacking_of(const std::filesystem::path& database);

}  // namespace study
