#pragma once
/// Register of exported files and folders and of the people whose data they contain. The entry of a file is
/// written before the file's first byte, so that a withdrawal finds every file.

#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/own_exports.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// The persons (session.person) of all sessions in a database.
std::set<std::string> everybody(sqlite::Connection& database);

/// Stores missing labels (export_labels.hpp) in a short write to the database. Call it before reading the
/// data of a public export. base::Error if the database cannot be written.
void label_everybody(const std::filesystem::path& database);

/// Opens a study for reading, so that its export can be registered while the data are read. A database that
/// is not in WAL mode is switched to it: in other modes a database cannot be written while it is read.
/// base::Error if the database cannot be written.
std::unique_ptr<sqlite::Connection> open_to_export(const StudyFile& study);

/// Registers one export while it is made. `people`: the persons (session.person) whose data it contains.
///
///   RegisteredExport record(database, "csv", folder, people);  // before the first byte
///   ... write record.draft() ...
///   record.will_be(sha256);                                     // the draft is complete
///   ... rename ...
///   record.is_in_place();
///
/// The export is entered in two registers. A withdrawal searches the register in the database, but deletes an
/// export only if it is also in the register of this installation (own_exports.hpp). Each call writes the
/// database briefly and upgrades an older schema. base::Error if the database cannot be written, because a
/// withdrawal could then not find the export. An installation's register that cannot be written is no error.
/// An export of a central database ("service:NAME") is entered in this installation's register alone.
class RegisteredExport {
 public:
  /// draft: path to which the export is written before it is renamed to `path`; empty: a generated name.
  RegisteredExport(const std::filesystem::path& database, const std::string& kind,
                   const std::filesystem::path& path, const std::set<std::string>& people,
                   const std::filesystem::path& draft = {});
  /// Removes the entry unless will_be() was called; after will_be(), the export may be at its path.
  ~RegisteredExport();
  RegisteredExport(const RegisteredExport&) = delete;
  RegisteredExport& operator=(const RegisteredExport&) = delete;

  const std::string& id() const { return own_.id; }
  /// Path to which the export is written first: in the same folder, by default with a random name.
  const std::filesystem::path& draft() const { return own_.draft; }
  /// Declares the content of the export. Call it before the rename: a withdrawal deletes the file or folder
  /// at the path only if it has this content. sha256: of a file's bytes, or of a folder's list_of_files().
  void will_be(const std::string& sha256);
  /// Call after the rename; flushes the rename to disk. base::Error, with the export deleted, if a person in
  /// the export withdrew in the meantime.
  void is_in_place();

 private:
  void keep_own();

  std::filesystem::path database_;
  OwnExport own_;
  bool named_ = false;
};

/// Writes and registers single files with people's data, such as reports. Construct it before the data are
/// read.
class RegisteredFiles {
 public:
  explicit RegisteredFiles(const StudyFile& study);
  /// Makes a missing folder for write(), and its missing parents, with mode 0700. A withdrawal that deletes
  /// the last file in the folder removes the folder.
  void make_folder(const std::filesystem::path& folder) const;
  /// Writes a file completely or not at all, with mode 0600 whatever the umask; replaces an earlier file.
  void write(const std::string& kind, const std::filesystem::path& path, const std::string& bytes) const;

 private:
  std::filesystem::path database_;
  std::set<std::string> people_;
};

/// True if a registered export contains data of a person who withdrew, and was made on this computer or on a
/// computer that is not recorded.
bool holds_withdrawn(sqlite::Connection& database);

/// Deletes every registered export that contains a person who withdrew, and the drafts beside it that remain
/// from a killed program. Then removes empty folders that were made for exports. A deletion is on disk before
/// the register's row is deleted.
///
/// Deletes an export only if it is in the register of this installation and its content is unchanged. Lists
/// in done.left the exports that it does not delete: on another computer, not registered by this
/// installation, changed, or not deletable. A missing export is listed once, since it may have been moved.
void delete_exports_of_withdrawn(sqlite::Connection& database, CleanUp& done);

/// For a study that was read from a central database: deletes every unchanged export that this installation
/// made from it and that contains a person who withdrew. Lists in done.left such exports that it cannot
/// delete, and exports with a person who is not in the study any more.
void delete_exports_of_service(sqlite::Connection& study, CleanUp& done);

/// Functions on rows of the table `export`, used by the register and by the deletion of exports.
namespace export_rows {

/// Value of the column `kind` for a folder that was made for registered files. Such a row lists no people;
/// the folder is removed once it is empty.
inline constexpr const char* folder_kind = "folder";

/// Name of this computer; empty if it has none.
std::string this_host();

void strike_out(sqlite::Connection& database, std::int64_t id);

}  // namespace export_rows

}  // namespace study
