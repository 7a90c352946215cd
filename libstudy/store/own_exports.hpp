#pragma once
/// The register of exports that this installation made, beside the program's data: a database tells where
/// exports of it lie, but only what stands here as well is ever deleted. So a database of somebody else,
/// which may name any path, deletes nothing.
///
/// "<state folder>/exports.jsonl", mode 0600, one JSON object a line. The state folder is $VIP_STATE_DIR,
/// else vip-lab in $XDG_STATE_HOME or in ~/.local/state. Where there is none, or where it cannot be written,
/// exports are made all the same, and a withdrawal names them instead of deleting them.

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace study {

/// An export, as its maker wrote it down.
struct OwnExport {
  std::string id;  ///< random; also in the export itself, where it is a folder
  std::string host, kind;
  std::filesystem::path database, path;
  std::filesystem::path draft;   ///< where it stands until it is in place, and while it is deleted
  std::string sha256;            ///< of a file, of a folder's list of files; empty: not yet whole
  std::set<std::string> people;  ///< session.person of those in it
  bool deleted = false;          ///< by this program, or about to be
};

/// 32 random hexadecimal digits.
std::string new_export_id();

/// The register's file; empty: there is no state folder.
std::filesystem::path own_exports_file();
/// Why exports cannot be registered here; none: they can.
std::optional<std::string> why_not_registered();

/// What is registered at a path of this computer, the newest last. A line that cannot be read registers
/// nothing. base::Error: the file cannot be read, or others may write it.
std::vector<OwnExport> own_exports_at(const std::filesystem::path& path);
/// Adds an export, or replaces the one of its id. base::Error when it cannot be written.
void keep_own_export(const OwnExport& made);
/// Takes exports out of the register, where they stand there.
void forget_own_exports(const std::set<std::string>& ids);

/// Notes that this program is about to delete an export.
void will_delete_own_export(OwnExport made);
/// Once it is deleted, the register keeps a digest of its place and content alone.
void has_deleted_own_export(const OwnExport& made);
/// Whether this installation deleted what a database says stands at a path. Another database, merged before,
/// may name it still.
bool was_deleted_here(const std::filesystem::path& path, const std::string& sha256);

/// The list of a folder's files, "<SHA-256>  <name>" a line as sha256sum -c reads it, under a line with its
/// id. It stands in the folder itself, as marker_of() its kind, and lists all other files.
std::string list_of_files(const std::filesystem::path& folder, const std::string& kind,
                          const std::string& id);
/// Name of the list of hashes in an exported folder of this kind; empty if this kind is a single file.
std::string marker_of(const std::string& kind);
/// Whether what stands at its path is this export, whole, unchanged and without any file of others.
bool stands_unchanged(const OwnExport& made);

}  // namespace study
