/// Any bytes as a database: opened for reading, then for writing; both end in data or in a base::Error.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "libstudy/store/ratings.hpp"
#include "libstudy/store/status.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

namespace fs = std::filesystem;

/// A folder of this process's own, in memory where there is such a file system.
fs::path make_folder() {
  const fs::path memory = "/dev/shm";
  std::string name =
      ((::access(memory.c_str(), W_OK) == 0 ? memory : fs::temp_directory_path()) / "vip-fuzz-XXXXXX");
  return ::mkdtemp(name.data());
}

struct Folder {
  fs::path path = make_folder();
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

template <class Action>
void attempt(Action action) {
  try {
    action();
  } catch (const base::Error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  const fs::path file = folder.path / "study.db";
  for (const auto& entry : fs::directory_iterator(folder.path)) fs::remove(entry.path());
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  if (std::FILE* out = std::fopen(file.c_str(), "wb")) {
    std::fwrite(bytes.data(), 1, bytes.size(), out);
    std::fclose(out);
  }
  attempt([&] { study::read_status(file); });
  attempt([&] { study::read_ratings(file); });
  // Reading leaves the file as it was.
  if (base::read_file(file, size + 1) != bytes) std::abort();
  attempt([&] { study::Store(file, study::sqlite::Open::Write).open_runs(); });
  return 0;
}
