#pragma once
/// A file that is written under a name of its own and then takes its place at once.

#include <filesystem>
#include <string>
#include <string_view>

namespace base {

/// Who may read a file: its owner alone (0600), or whoever the umask lets.
enum class Readers { Owner, AsUmask };

/// 16 random hexadecimal digits, not to be guessed.
std::string random_digits();

/// `path` + ".tmp" + 16 random hexadecimal digits: beside `path`, and not to be guessed by others who may
/// write there.
std::filesystem::path draft_name(const std::filesystem::path& path);

/// Whether `name` is `target` + ".tmp" + hexadecimal digits.
bool is_draft_name(const std::string& name, const std::string& target);

/// Deletes drafts of `path` that a kill left: those that no NewFile holds.
void remove_stale_drafts(const std::filesystem::path& path);

/// base::Error unless a file can be put at `path`: a file stands there or nothing, and no device or the like,
/// which the file would replace; in a folder that one may write to, or may make. Makes nothing.
void check_output(const std::filesystem::path& path);

/// The same of files in a folder that is there or is to be made.
void check_output_folder(const std::filesystem::path& folder);

/// Makes the folder that `path` is to stand in, with those above it, unless it is there; returns the topmost
/// that was made, empty where none was. base::Error names `path`.
std::filesystem::path make_folder_of(const std::filesystem::path& path);

/// A new file beside `path`. It is made for this object alone: a file or link that is already there is never
/// written through. It goes with the object unless it was put in place, and so do the folders that had to be
/// made for it; it is locked (flock) as long as the object lives. Errors are base::Error and name `path`;
/// check_output() is asked first.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& path, Readers readers = Readers::AsUmask);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);

  /// Where it stands until it is put in place.
  const std::filesystem::path& draft() const { return draft_; }

  /// Syncs the file, renames it over `path` and syncs the folder, and those above it that were made. The
  /// rights are 0600 for Readers::Owner, else those of the file that stood there, else what the umask leaves.
  void put_in_place();

 private:
  bool make_draft();
  [[noreturn]] void fail(const std::string& step) const;

  std::filesystem::path path_, draft_;
  std::filesystem::path made_;  ///< topmost folder made for it; empty: none, or the file is in place
  Readers readers_;
  int fd_ = -1;
};

/// Waits for, and holds, the lock of the file at `path`: a file beside it, `path` + ".lock", which stays. For
/// what is read and replaced by several programs. Errors are base::Error.
class FileLock {
 public:
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace base
