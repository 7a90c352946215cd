#include "libstudy/protocol/find_protocol.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> shipped_names(const fs::path& folder) {
  std::vector<std::string> out;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".toml") out.push_back(entry.path().stem());
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

fs::path find_protocol(const fs::path& named) {
  std::error_code ignored;
  const bool bare = !named.has_parent_path() && (named.extension().empty() || named.extension() == ".toml");
  // A folder with a protocol's name is more likely a study's output than a protocol.
  if (!bare || (fs::exists(named, ignored) && !fs::is_directory(named, ignored)))
    return base::find_input(named);
  const fs::path folder = base::resource("protocols");
  const fs::path shipped = folder / (named.stem().string() + ".toml");
  if (fs::exists(shipped, ignored)) return shipped;
  const std::vector<std::string> names = shipped_names(folder);
  const std::string choice = names.empty() ? "" : ", or " + base::use_one_of(named.stem().string(), names);
  throw base::Error(named.string(), "is neither a file nor the name of a protocol in " + folder.string(),
                    "check the path" + choice);
}

}  // namespace study
