#pragma once
/// Databases with malicious content: each is a valid study with one thing that vip-study never writes.

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace study::test {

struct HostileFile {
  const char* name;
  const char* kind;
  /// Spoils the valid study at the path; `other` is an unrelated study.
  std::function<void(const std::filesystem::path& path, const std::filesystem::path& other)> spoil;
  const char* reason;    ///< part of the error message that rejects it
  bool salvaged = true;  ///< salvage recovers all answers without the journal
};

const std::vector<HostileFile>& hostile_files();

/// Runs SQL on a file with all of SQLite's protections off.
void spoil_with(const std::filesystem::path& path, const std::string& sql);

/// Bytes of all files in a folder, by path.
std::map<std::string, std::string> everything_in(const std::filesystem::path& folder);

/// Kills the process, and so the test, if the scope takes more than this number of seconds of processor time.
class ProcessorTime {
 public:
  explicit ProcessorTime(int seconds);
  ~ProcessorTime();
};

}  // namespace study::test
