#include "libstudy/store/file/beside.hpp"

#include "stats/base/error.hpp"

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

std::optional<std::string> service_of(const fs::path& path) {
  constexpr std::string_view mark = "service:";
  if (!path.native().starts_with(mark)) return {};
  return path.native().substr(mark.size());
}

void refuse_service(const fs::path& path) {
  if (!service_of(path)) return;
  throw base::Error(path.string(), "is a central database, which this command does not write",
                    "name the database of a station; vip-study push sends it to the central database");
}

fs::path beside(const fs::path& database, const std::string& suffix) {
  return real_file(database).string() + suffix;
}

}  // namespace study
