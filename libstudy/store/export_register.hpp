#pragma once
/// Which files and folders outside the database hold data of whom: written down before their first byte, so
/// that a withdrawal finds them again.

#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/own_exports.hpp"
#include "libstudy/store/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// session.person of everybody who stands in a database.
std::set<std::string> everybody(sqlite::Connection& database);

/// Stores labels of whom and what has none yet (export_labels.hpp), before a public export is read. The
/// database is written for a moment; base::Error as RegisteredExport.
void label_everybody(const std::filesystem::path& database);

/// A study that is read while its export is registered. A database without a log, as other programs may leave
/// it, is given one: no write would be let in while it is read. base::Error as RegisteredExport.
std::unique_ptr<sqlite::Connection> open_to_export(const StudyFile& study);

/// One export while it is made: `people` stand in it.
///
///   RegisteredExport record(database, "csv", folder, people);  // before the first byte
///   ... write record.draft() ...
///   record.will_be(sha256);                                     // whole, beside its place
///   ... rename ...
///   record.is_in_place();
///
/// It stands in two registers: in the database, where a withdrawal looks, and in that of this installation
/// (own_exports.hpp), without which nothing is deleted. The first is written for a moment each time; a
/// database of an older schema is upgraded. base::Error: the database cannot be written, so that the export
/// could not be found again. When the second cannot be written the export is made all the same.
class RegisteredExport {
 public:
  /// draft: where it is written first; empty: draft() gives a name.
  RegisteredExport(const std::filesystem::path& database, const std::string& kind,
                   const std::filesystem::path& path, const std::set<std::string>& people,
                   const std::filesystem::path& draft = {});
  /// Strikes the export out again unless it came so far that something of it may be in place.
  ~RegisteredExport();
  RegisteredExport(const RegisteredExport&) = delete;
  RegisteredExport& operator=(const RegisteredExport&) = delete;

  const std::string& id() const { return own_.id; }
  /// Where it is written first: beside its place, under a name that nobody can guess.
  const std::filesystem::path& draft() const { return own_.draft; }
  /// What is put in place next; a withdrawal deletes nothing else there. sha256: of a file's bytes, or of a
  /// folder's list_of_files().
  void will_be(const std::string& sha256);
  /// It is there, and that is on the disk. base::Error, and it is gone again, when one of its people withdrew
  /// in the meantime.
  void is_in_place();

 private:
  void keep_own();

  std::filesystem::path database_;
  OwnExport own_;
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

/// True when a registered export holds somebody who withdrew and can be dealt with on this computer.
bool holds_withdrawn(sqlite::Connection& database);

/// Deletes every registered export that holds somebody who withdrew, with what a kill left of it beside its
/// place, and then the folders that were made for such files and are empty. Each deletion is on the disk
/// before its row is struck out.
///
/// Only what stands in the register of this installation, with the same content and with somebody who
/// withdrew, is deleted. Named as left: what is on another computer, what this installation did not register,
/// what was changed, and what cannot be deleted; and once, what is no longer there, since it may have been
/// moved.
void delete_exports_of_withdrawn(sqlite::Connection& database, CleanUp& done);

}  // namespace study
