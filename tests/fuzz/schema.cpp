/// Any bytes as choices of SQL that spoils a database (database_grammar.hpp): every command refuses it or
/// handles it correctly.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "libstudy/store/store.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/fuzz/database_attack.hpp"

namespace fs = std::filesystem;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::TemporaryFolder folder;
  static const fs::path sound = [] {
    const fs::path path = folder / "sound.db";
    fs::copy_file(base::resource("tests/libstudy/fixtures/study_v4.db"), path);
    study::Store(path, study::sqlite::Open::Write);  // opening for writing adds the journal of answers
    return path;
  }();
  const auto wrong = fuzz::attack(folder.path(), sound, data, size);
  for (const std::string& line : wrong) std::fprintf(stderr, "%s\n", line.c_str());
  if (!wrong.empty()) std::abort();
  return 0;
}
