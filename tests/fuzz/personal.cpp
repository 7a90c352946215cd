/// Any bytes as the file of personal data beside a database: its answers can be read, added to, moved to
/// another participant and deleted, or base::Error refuses.
#include "libstudy/store/personal.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/common/temporary_folder.hpp"
#include "tests/fuzz/attempt.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace fs = std::filesystem;
  static const test::TemporaryFolder folder;
  for (const auto& entry : fs::directory_iterator(folder.path())) fs::remove(entry.path());
  if (std::FILE* out = std::fopen((folder / "s.db.personal").c_str(), "wb")) {
    if (size > 0) std::fwrite(data, 1, size, out);  // libFuzzer's empty input is a null pointer
    std::fclose(out);
  }
  fuzz::attempt([&] {
    study::PersonalFile file(folder / "s.db");
    file.read("P01");
    file.keep({{"P07", "age", "Your age", "33"}});
    if (file.read("P07").empty()) std::abort();
    file.rename("batch", {{"P07", "P08"}});
    file.forget("P08");
    if (!file.read("P08").empty()) std::abort();
  });
  return 0;
}
