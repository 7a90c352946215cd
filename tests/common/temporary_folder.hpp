#pragma once
/// A folder for the files of one test.

#include <stdlib.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace test {

/// Folder of the tests' files: in memory, where writing does not wait for a disk, if 2 GiB are free there, or
/// else the usual temporary folder.
inline std::filesystem::path usual_folder() {
  const std::filesystem::path memory = "/dev/shm";
  std::error_code problem;
  const auto space = std::filesystem::space(memory, problem);
  const bool large = !problem && space.available >= std::uintmax_t{2} << 30;
  return large && ::access(memory.c_str(), W_OK) == 0 ? memory : std::filesystem::temp_directory_path();
}

/// A new folder in `where`. The destructor removes it with its contents, and makes its folders writable if it
/// must.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::filesystem::path& where = usual_folder()) {
    std::string name = (where / "vip-test-XXXXXX").string();
    if (!::mkdtemp(name.data()))
      throw std::runtime_error("cannot make the folder " + name +
                               "; mend: free its disk and allow writing beside it");
    path_ = name;
  }
  ~TemporaryFolder() {
    namespace fs = std::filesystem;
    std::error_code problem;
    fs::remove_all(path_, problem);
    if (!problem) return;
    fs::permissions(path_, fs::perms::owner_all, problem);
    for (fs::recursive_directory_iterator at(path_, problem), end; at != end; at.increment(problem))
      if (at->is_directory(problem) && !at->is_symlink(problem))
        fs::permissions(at->path(), fs::perms::owner_all, problem);
    fs::remove_all(path_, problem);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace test
