#pragma once
/// The register of exports that this installation made, in the user's state folder. A database lists its
/// exports, but only exports that are also in this register are ever deleted. So a foreign database, which
/// may name any path, deletes nothing.
///
/// "<state folder>/exports.jsonl", mode 0600, one JSON object a line. The state folder is $VIP_STATE_DIR,
/// else vip-lab in $XDG_STATE_HOME or in ~/.local/state. If there is none or it cannot be written, exports
/// are made all the same, and a withdrawal names them instead of deleting them.

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace study {

/// A registered export.
struct OwnExport {
  std::string id;  ///< random; also in the export itself if it is a folder
  std::string host, kind;
  std::filesystem::path database, path;
  std::filesystem::path draft;   ///< its path before it is in place and during deletion
  std::string sha256;            ///< of a file, or of a folder's list of files; empty: incomplete
  std::set<std::string> people;  ///< session.person of the people in it
  bool deleted = false;          ///< by this program, or about to be
};

/// 32 random hexadecimal digits.
std::string new_export_id();

/// The register's file; empty if there is no state folder.
std::filesystem::path own_exports_file();
/// The reason that this computer cannot register exports; none if it can.
std::optional<std::string> why_not_registered();

/// The exports registered at a path of this computer, newest last. Unreadable lines are ignored. base::Error:
/// the file cannot be read, or others may write it.
std::vector<OwnExport> own_exports_at(const std::filesystem::path& path);
/// Adds an export, or replaces the one with its id. base::Error if the register cannot be written.
void keep_own_export(const OwnExport& made);
/// Removes exports from the register, if present.
void forget_own_exports(const std::set<std::string>& ids);

/// Notes that this program is about to delete an export.
void will_delete_own_export(OwnExport made);
/// Call after the deletion: the register then stores only a digest of path and content.
void has_deleted_own_export(const OwnExport& made);
/// True if this installation deleted the export that a database lists at a path. Another database, merged
/// before, may still list it.
bool was_deleted_here(const std::filesystem::path& path, const std::string& sha256);

/// The list of a folder's files, "<SHA-256> <name>" a line as sha256sum -c reads it, below a line with
/// the export's id. It is stored in the folder itself as marker_of(kind) and lists all other files.
std::string list_of_files(const std::filesystem::path& folder, const std::string& kind,
                          const std::string& id);
/// Path of the list of hashes in an exported folder of this kind; empty if this kind is a single file.
std::string marker_of(const std::string& kind);
/// True if the file or folder at its path is this export, complete, unchanged and without other files.
bool stands_unchanged(const OwnExport& made);

}  // namespace study
