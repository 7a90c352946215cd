/// Any bytes as a database, opened for reading and then for writing: both give data or a base::Error.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "libstudy/store/read/sickness.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/fuzz/attempt.hpp"

namespace fs = std::filesystem;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::TemporaryFolder folder;
  const fs::path file = folder / "study.db";
  for (const auto& entry : fs::directory_iterator(folder.path())) fs::remove(entry.path());
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  if (std::FILE* out = std::fopen(file.c_str(), "wb")) {
    std::fwrite(bytes.data(), 1, bytes.size(), out);
    std::fclose(out);
  }
  fuzz::attempt([&] { study::read_status(file); });
  fuzz::attempt([&] { study::read_tasks(file); });
  fuzz::attempt([&] { study::read_sickness(file); });
  // Reading must not change the file.
  if (base::read_file(file, size + 1) != bytes) std::abort();
  fuzz::attempt([&] { study::Store(file, study::sqlite::Open::Write).open_runs(); });
  return 0;
}
