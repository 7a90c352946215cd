#include "libstudy/store/file/lock_holder.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <sstream>

namespace study {

namespace {

/// A file's name in /proc/locks; empty if there is no file.
std::string kernel_name(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return {};
  return fmt::format("{:02x}:{:02x}:{}", major(file.st_dev), minor(file.st_dev), file.st_ino);
}

}  // namespace

// Reads the list of all locks instead of asking with a descriptor, because closing that would release
// SQLite's locks.
std::string lock_holder(const std::filesystem::path& database) {
  const std::string file = kernel_name(database.string()), shared = kernel_name(database.string() + "-shm");
  std::set<long> holders;
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, strictness, access, name;
    long process = 0;
    if (!(words >> number >> kind >> strictness >> access >> process >> name)) continue;
    const bool ours = process == ::getpid();
    if (kind == "POSIX" && access == "WRITE" && !ours && process > 0 && (name == file || name == shared))
      holders.insert(process);
  }
  std::string text;
  for (const long process : holders) {
    std::string program;
    std::ifstream comm("/proc/" + std::to_string(process) + "/comm");
    std::getline(comm, program);
    text += (text.empty() ? "" : ", ") + (program.empty() ? "a program" : program) + " (process " +
            std::to_string(process) + ")";
  }
  return text.empty() ? "another program" : text;
}

}  // namespace study
