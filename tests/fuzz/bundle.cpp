/// A preregistration bundle in which one file has any bytes and the right hash: it is read and compared with
/// made results of a study, or refused with base::Error. The first byte of the input chooses the file.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/fuzz/attempt.hpp"

namespace {

namespace fs = std::filesystem;
using Json = base::Json;

constexpr const char* names[] = {"about.json", "hypotheses.json", "plan.toml", "MANIFEST.sha256"};

/// A bundle and the frozen content of its files.
struct Frozen {
  Frozen() {
    study::report::freeze_bundle({{base::resource("protocols/task2.toml")}, {}, {}}, path);
    for (const char* name : names) files[name] = base::read_file(path / name, 1 << 20);
    protocol = study::read_protocol(base::resource("protocols/task2.toml")).sha256;
  }
  test::TemporaryFolder folder;
  fs::path path = folder / "bundle";
  std::map<std::string, std::string> files;
  std::string protocol;
};

void write(const fs::path& path, const std::string& bytes) {
  fs::permissions(path, fs::perms::owner_all);
  if (std::FILE* out = std::fopen(path.c_str(), "wb")) {
    std::fwrite(bytes.data(), 1, bytes.size(), out);
    std::fclose(out);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Frozen frozen;
  if (size == 0) return 0;
  const std::string name = names[data[0] % std::size(names)];
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  for (const auto& [file, whole] : frozen.files) write(frozen.path / file, file == name ? bytes : whole);
  if (name != "MANIFEST.sha256") {
    std::string manifest = frozen.files.at("MANIFEST.sha256");
    const std::string before = base::sha256_hex(frozen.files.at(name));
    write(frozen.path / "MANIFEST.sha256",
          manifest.replace(manifest.find(before), before.size(), base::sha256_hex(bytes)));
  }
  fuzz::attempt([&] {
    const auto bundle = study::report::read_bundle(frozen.path);
    const Json results{{"study",
                        {{"protocols", Json::array({{{"task", "task2"},
                                                     {"title", "Task 2"},
                                                     {"sha256", frozen.protocol},
                                                     {"first_answer_utc", "2026-01-31T12:00:00Z"}}})}}},
                       {"hypotheses", Json::array()}};
    study::report::compare_with_bundle(bundle, {}, results);
  });
  return 0;
}
