#pragma once
/// Which files and folders outside the database hold data of whom: written down before their first byte, so
/// that a withdrawal finds them again.

#include <filesystem>
#include <set>
#include <string>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// session.person of everybody who stands in a database.
std::set<std::string> everybody(sqlite::Connection& database);

/// Finishes a commit that a kill cut short, before an export writes down its own event: rows of the journal
/// that are under way have their numbers already. Does nothing beside a session, which finishes its own. To
/// be called before this process opens the database in another way. Never throws: opening the study says what
/// is wrong.
void finish_cut_commit(const StudyFile& study);

/// One export while it is made: `people` stand in it.
///
///   RegisteredExport record(database, "csv", folder, people);  // before the first byte
///   record.will_be(sha256);                                     // whole, beside its place
///   ... rename ...
///   record.is_in_place();
///
/// The database is written for a moment each time; one of an older schema is upgraded. base::Error: it cannot
/// be written, so that the export could not be found again.
class RegisteredExport {
 public:
  RegisteredExport(const std::filesystem::path& database, const std::string& kind,
                   const std::filesystem::path& path, const std::set<std::string>& people);
  /// Strikes the export out again unless it came so far that something of it may be in place.
  ~RegisteredExport();
  RegisteredExport(const RegisteredExport&) = delete;
  RegisteredExport& operator=(const RegisteredExport&) = delete;

  /// Where it goes: absolute, without links.
  const std::filesystem::path& path() const { return path_; }
  /// What is put in place next; a withdrawal deletes nothing else there. sha256: of a file's bytes, or
  /// sha256_of_names().
  void will_be(const std::string& sha256);
  /// It is there. base::Error, and it is gone again, when one of its people withdrew in the meantime.
  void is_in_place();

 private:
  std::filesystem::path database_, path_;
  std::string kind_;
  std::set<std::string> people_;
  bool named_ = false;
};

/// Writes single files that hold values of people, such as a report; make it before their data are read.
class RegisteredFiles {
 public:
  explicit RegisteredFiles(const StudyFile& study);
  /// Makes a missing folder for such files, 0700, with those above it. What is made here is removed by the
  /// withdrawal that leaves it empty.
  void make_folder(const std::filesystem::path& folder) const;
  /// Puts a file in place, 0600 whatever the umask and whatever stood there.
  void write(const std::string& kind, const std::filesystem::path& path, const std::string& bytes) const;

 private:
  std::filesystem::path database_;
  std::set<std::string> people_;
};

/// SHA-256 of the names of all files below a folder.
std::string sha256_of_names(const std::filesystem::path& folder);

/// Where a draft of an export stands until it is put in place: beside it.
std::filesystem::path draft_of(const std::filesystem::path& path);

/// True when a registered export holds somebody who withdrew and can be dealt with on this computer.
bool holds_withdrawn(sqlite::Connection& database);

/// Deletes every registered export that holds somebody who withdrew, with the drafts that a kill left beside
/// it, and then the folders that were made for such files and are empty. Named as left: what is on another
/// computer, is not what was written there, or cannot be deleted; and once, what is no longer there, since it
/// may have been moved.
void delete_exports_of_withdrawn(sqlite::Connection& database, CleanUp& done);

}  // namespace study
