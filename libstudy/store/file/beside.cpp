#include "libstudy/store/file/beside.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {
constexpr int most_links = 40;  // Linux follows at most 40 links, too
}

fs::path real_file(const fs::path& path) {
  fs::path file = path;
  std::error_code ignored;
  for (int links = 0; links < most_links && fs::is_symlink(file, ignored); ++links) {
    const fs::path to = fs::read_symlink(file, ignored);
    file = to.is_absolute() ? to : file.parent_path() / to;
  }
  return file;
}

fs::path beside(const fs::path& database, const std::string& suffix) {
  return real_file(database).string() + suffix;
}

}  // namespace study
