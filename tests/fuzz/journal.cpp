/// Any bytes as the journal of answers. Alone, it is salvaged or refused. Beside a whole database, opening
/// the database for writing reconciles the two or refuses. Neither loses answers of the database.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/fuzz/attempt.hpp"

namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& bytes) {
  if (std::FILE* out = std::fopen(path.c_str(), "wb")) {
    std::fwrite(bytes.data(), 1, bytes.size(), out);
    std::fclose(out);
  }
}

/// A database of the current schema with answers, upgraded only once for all inputs.
std::string whole_database() {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "s.db";
  write(path, base::read_file(base::resource("tests/libstudy/fixtures/study_v2.db"), 1 << 24));
  study::Store(path, study::sqlite::Open::Write);
  return base::read_file(path, 1 << 24);
}

std::int64_t answers_in(const fs::path& database) {
  return study::sqlite::Connection(database, study::sqlite::Open::Read)
      .integer("SELECT count(*) FROM response");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::TemporaryFolder folder;
  static const std::string whole = whole_database();
  for (const auto& entry : fs::directory_iterator(folder.path())) fs::remove(entry.path());
  const fs::path database = folder / "s.db";
  write(study::journal_beside(database), {reinterpret_cast<const char*>(data), size});
  fuzz::attempt([&] { study::salvage(database, folder / "new.db"); });
  write(database, whole);
  const std::int64_t before = answers_in(database);
  fuzz::attempt([&] { study::Store(database, study::sqlite::Open::Write).open_runs(); });
  if (answers_in(database) < before) std::abort();
  return 0;
}
