#pragma once
/// Register of files and folders outside the database and the people whose data they hold. An entry is
/// written before the first byte of a file, so that a withdrawal finds it.

#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/own_exports.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// session.person of all people in a database.
std::set<std::string> everybody(sqlite::Connection& database);

/// Stores missing labels (export_labels.hpp) before the data of a public export are read. Writes the database
/// briefly; base::Error as RegisteredExport.
void label_everybody(const std::filesystem::path& database);

/// Opens a study for reading while its export is registered. Switches a database without a log, as other
/// programs may leave it, to WAL mode; otherwise it could not be written while it is read. base::Error as
/// RegisteredExport.
std::unique_ptr<sqlite::Connection> open_to_export(const StudyFile& study);

/// Registers one export while it is made; `people` are the people in it.
///
///   RegisteredExport record(database, "csv", folder, people);  // before the first byte
///   ... write record.draft() ...
///   record.will_be(sha256);                                     // whole, beside its place
///   ... rename ...
///   record.is_in_place();
///
/// The export is entered in two registers: the database's, where a withdrawal looks, and this installation's
/// (own_exports.hpp), without which nothing is deleted. Each step writes the database briefly and upgrades an
/// older schema. base::Error if the database cannot be written, because the export could then not be found
/// again. If the second register cannot be written, the export is made all the same.
class RegisteredExport {
 public:
  /// draft: path that is written first; empty: a generated name, see draft().
  RegisteredExport(const std::filesystem::path& database, const std::string& kind,
                   const std::filesystem::path& path, const std::set<std::string>& people,
                   const std::filesystem::path& draft = {});
  /// Removes the entry unless will_be() was called, after which the export may be in place.
  ~RegisteredExport();
  RegisteredExport(const RegisteredExport&) = delete;
  RegisteredExport& operator=(const RegisteredExport&) = delete;

  const std::string& id() const { return own_.id; }
  /// Path that is written first: beside the target, under a name that cannot be guessed.
  const std::filesystem::path& draft() const { return own_.draft; }
  /// Declares the content that is put in place next; a withdrawal deletes nothing else at that path. sha256:
  /// of a file's bytes, or of a folder's list_of_files().
  void will_be(const std::string& sha256);
  /// Call after the rename; flushes it to disk. base::Error, with the export deleted, if one of its people
  /// withdrew in the meantime.
  void is_in_place();

 private:
  void keep_own();

  std::filesystem::path database_;
  OwnExport own_;
  bool named_ = false;
};

/// Writes single files with people's data, such as a report. Construct it before the data are read.
class RegisteredFiles {
 public:
  explicit RegisteredFiles(const StudyFile& study);
  /// Makes a missing folder for write(), 0700, and its parents. A withdrawal that empties it removes it.
  void make_folder(const std::filesystem::path& folder) const;
  /// Puts a file in place, mode 0600 whatever the umask, replacing an earlier one.
  void write(const std::string& kind, const std::filesystem::path& path, const std::string& bytes) const;

 private:
  std::filesystem::path database_;
  std::set<std::string> people_;
};

/// True if a registered export holds somebody who withdrew and can be handled on this computer.
bool holds_withdrawn(sqlite::Connection& database);

/// Deletes every registered export that holds somebody who withdrew, with drafts that a kill left beside it,
/// and then the empty folders made for exports. Each deletion is on disk before its row is deleted.
///
/// Deletes only exports in the register of this installation with unchanged content and with somebody who
/// withdrew. Lists in done.left: exports on another computer, not registered by this installation, changed,
/// or not deletable; and once, missing ones, since they may have been moved.
void delete_exports_of_withdrawn(sqlite::Connection& database, CleanUp& done);

/// Rows of the table `export`, shared by the register and the deletion of exports.
namespace export_rows {

/// Kind of a folder made for registered files. It holds no people itself and is removed when it is empty.
inline constexpr const char* folder_kind = "folder";

/// Name of this computer; empty if it has none.
std::string this_host();

void strike_out(sqlite::Connection& database, std::int64_t id);

}  // namespace export_rows

}  // namespace study
