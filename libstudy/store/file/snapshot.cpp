#include "libstudy/store/file/snapshot.hpp"

#include <stdlib.h>
#include <sys/stat.h>

#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "libstudy/store/file/private_file.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;

namespace {

constexpr std::array parts{"", "-wal", "-journal"};
constexpr int rounds = 5;

/// A folder for the owner only, deleted with its content.
class PrivateFolder {
 public:
  PrivateFolder() : path_((fs::temp_directory_path() / "vip-study-XXXXXX").string()) {
    if (!::mkdtemp(path_.data()))
      throw base::Error(path_, "cannot be made a folder", "set TMPDIR to a folder that you may write to");
  }
  ~PrivateFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  fs::path operator/(const std::string& name) const { return fs::path(path_) / name; }

 private:
  std::string path_;
};

/// Sizes and modification times: equal before and after a copy if it is consistent.
std::vector<std::tuple<long long, long long, long long>> state_of(const fs::path& path) {
  std::vector<std::tuple<long long, long long, long long>> state;
  for (const char* part : parts) {
    struct stat file {};
    if (::stat((path.string() + part).c_str(), &file) != 0) file = {};
    state.emplace_back(file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec);
  }
  return state;
}

void copy_parts(const fs::path& path, const fs::path& copy) {
  for (const char* part : parts) {
    const fs::path from = path.string() + part, to = copy.string() + part;
    std::error_code error;
    if (part[0] != '\0' && !fs::exists(from, error)) continue;
    create_private(to);
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
    if (error)
      throw base::Error(from.string(), "cannot be read: " + error.message(),
                        "copy the database and the files beside it to a folder that you own");
    make_private(to);
  }
}

}  // namespace

std::unique_ptr<Connection> snapshot(const fs::path& path) {
  for (int round = 0; round < rounds; ++round) {
    const PrivateFolder folder;
    const fs::path copied = folder / "copy.db";
    const auto before = state_of(path);
    copy_parts(path, copied);
    if (state_of(path) != before) continue;
    Connection whole(copied, sqlite::Open::Write);
    auto held = std::make_unique<Connection>(path, sqlite::Temporary{});
    held->copy_from(whole);
    return held;
  }
  throw base::Error(path.string(), "is being written to by somebody else",
                    "wait until that has ended, or copy it to a folder that you own");
}

}  // namespace study
