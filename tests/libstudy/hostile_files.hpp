#pragma once
/// Databases as a stranger would make them: each a sound study with one thing that vip-study never writes.

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace study::test {

struct HostileFile {
  const char* name;
  const char* kind;
  /// Spoils the sound study at the path; `other` is a study that has nothing to do with it.
  std::function<void(const std::filesystem::path& path, const std::filesystem::path& other)> spoil;
  const char* reason;    ///< part of the message that refuses it
  bool salvaged = true;  ///< salvage finds all answers in it
};

const std::vector<HostileFile>& hostile_files();

/// Runs SQL on a file with every protection of SQLite off, as the maker of such a file does.
void spoil_with(const std::filesystem::path& path, const std::string& sql);

/// Bytes, by path, of everything in a folder.
std::map<std::string, std::string> everything_in(const std::filesystem::path& folder);

/// Ends the process, and so the test, where the scope takes more than so many seconds of processor time.
class ProcessorTime {
 public:
  explicit ProcessorTime(int seconds);
  ~ProcessorTime();
};

}  // namespace study::test
