#pragma once
/// Files that are written under a temporary name and then renamed into place.

#include <filesystem>
#include <string>
#include <string_view>

namespace base {

/// Who may read a file: its owner alone (0600), or everyone whom the umask allows.
enum class Readers { Owner, AsUmask };

/// 16 hexadecimal digits from a cryptographic random generator.
std::string random_digits();

/// Name for a temporary file beside `path`: `path` + ".tmp" + 16 random hexadecimal digits. Other users of
/// the folder cannot guess the name and create a file or link under it first.
std::filesystem::path draft_name(const std::filesystem::path& path);

/// True if `name` is `target` + ".tmp" + hexadecimal digits.
bool is_draft_name(const std::string& name, const std::string& target);

/// Deletes temporary files of `path` (draft_name()) that a killed process left behind, that is, temporary
/// files that no NewFile has locked.
void remove_stale_drafts(const std::filesystem::path& path);

/// base::Error unless a file can be written to `path`: `path` is a regular file or does not exist (a device,
/// pipe or folder is refused), and its folder is writable or can be created. Creates nothing.
void check_output(const std::filesystem::path& path);

/// base::Error unless files can be written to `folder`: the folder is writable or can be created. Creates
/// nothing.
void check_output_folder(const std::filesystem::path& folder);

/// Creates the folder of `path` and its missing parents. Returns the topmost folder created; empty if none
/// was. base::Error names `path`.
std::filesystem::path make_folder_of(const std::filesystem::path& path);

/// A new file under a temporary name in the folder of `path`; put_in_place() renames it to `path`. It is
/// created exclusively (O_EXCL), so no existing file or link is overwritten by write(). If put_in_place() was
/// not called, the destructor deletes the file and those folders created for it that are empty. The file is
/// locked (flock) until put_in_place() or the destructor closes it. Errors are base::Error and name `path`.
/// The constructor calls check_output() first.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& path, Readers readers = Readers::AsUmask);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);

  /// Path of the file until it is put in place.
  const std::filesystem::path& draft() const { return draft_; }

  /// Syncs the file, renames it over `path`, and syncs its folder and any folders created above it. The
  /// permissions are 0600 for Readers::Owner, else those of the file replaced, else those that the umask
  /// leaves.
  void put_in_place();

 private:
  bool make_draft();
  [[noreturn]] void fail(const std::string& step) const;

  std::filesystem::path path_, draft_;
  std::filesystem::path made_;  ///< topmost folder created; empty if none or once the file is in place
  Readers readers_;
  int fd_ = -1;
};

/// An exclusive lock for a file that several programs read and replace. The constructor waits until the lock
/// is free; the destructor releases it. The locked file is `path` + ".lock", which is never deleted. Errors
/// are base::Error.
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
