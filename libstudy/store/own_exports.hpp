#pragma once
/// The register of exports that this installation made, in the user's state folder. Each database also lists
/// its exports, but a withdrawal deletes an export only if this register has it too. So a database from
/// elsewhere, which may list any path, cannot make the program delete other files.
///
/// The register is the file "<state folder>/exports.jsonl", mode 0600, with one JSON object per line. The
/// state folder is $VIP_STATE_DIR if set, else vip-lab in $XDG_STATE_HOME or in ~/.local/state. If there is
/// no state folder, or it cannot be written, exports are still made, but a withdrawal only lists their paths.

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace study {

/// A registered export.
struct OwnExport {
  std::string id;  ///< new_export_id(); a folder also contains it, in its list of files
  std::string host, kind;
  std::filesystem::path database, path;
  std::filesystem::path draft;   ///< path of the export while it is written and while it is deleted
  std::string sha256;            ///< of the file, or of the folder's list_of_files(); empty: incomplete
  std::set<std::string> people;  ///< persons (session.person) whose data the export contains
  bool deleted = false;          ///< this program deleted the export, or is about to delete it
};

/// A new id of an export: 32 random hexadecimal digits.
std::string new_export_id();

/// Path of the register; empty if there is no state folder.
std::filesystem::path own_exports_file();
/// The error text that says why the register cannot be written; none if writing it succeeds.
std::optional<std::string> why_not_registered();

/// The exports registered at a path of this computer, newest last. Ignores lines of the register that cannot
/// be parsed. base::Error if the register cannot be read, or if other users may write it.
std::vector<OwnExport> own_exports_at(const std::filesystem::path& path);
/// The exports of this computer that were made from a database, except those that are deleted. Throws as
/// own_exports_at().
std::vector<OwnExport> own_exports_of(const std::filesystem::path& database);
/// Adds an export to the register, or replaces the export with the same id. base::Error if the register
/// cannot be written.
void keep_own_export(const OwnExport& made);
/// Removes the exports with these ids from the register; ignores ids that are not in it.
void forget_own_exports(const std::set<std::string>& ids);

/// Notes in the register that this program is about to delete an export.
void will_delete_own_export(OwnExport made);
/// Call after the deletion: replaces the export's path, content and people in the register by one digest.
void has_deleted_own_export(const OwnExport& made);
/// True if this installation deleted the export with this path and SHA-256. A database that was merged before
/// the deletion may still list such an export.
bool was_deleted_here(const std::filesystem::path& path, const std::string& sha256);

/// Text that lists the files of an exported folder: a line with the export's id, then one line per file,
/// "<SHA-256>  <name>", which sha256sum -c can check. The folder stores this text in the file
/// marker_of(kind), which the list omits.
std::string list_of_files(const std::filesystem::path& folder, const std::string& kind,
                          const std::string& id);
/// Path, within an exported folder of this kind, of the file with list_of_files(); empty if exports of this
/// kind are single files.
std::string marker_of(const std::string& kind);
/// True if the file or folder at made.path is this export: complete, unchanged and without other files.
bool stands_unchanged(const OwnExport& made);

}  // namespace study
