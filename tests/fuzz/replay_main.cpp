/// usage: PROGRAM ROUNDS FOLDER. Replays the corpus in FOLDER through LLVMFuzzerTestOneInput: each file as it
/// is, truncated at ROUNDS / 4 places, and with ROUNDS mutations from a fixed seed. A crash, a sanitizer
/// report or an exception that leaves the entry point fails the test.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

void feed(const Bytes& bytes) { LLVMFuzzerTestOneInput(bytes.data(), bytes.size()); }

Bytes mutated(Bytes bytes, std::mt19937_64& random) {
  const auto edits = 1 + random() % 4;
  for (std::uint64_t i = 0; i < edits && !bytes.empty(); ++i) {
    const std::size_t at = random() % bytes.size();
    switch (random() % 4) {
      case 0:
        bytes[at] = static_cast<std::uint8_t>(random());
        break;
      case 1:
        bytes[at] ^= static_cast<std::uint8_t>(1u << (random() % 8));
        break;
      case 2:
        bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
        break;
      default:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), static_cast<std::uint8_t>(random()));
        break;
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::size_t rounds = std::stoul(argv[1]), cuts = rounds / 4;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[2])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::size_t fed = 0;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    const Bytes bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    feed(bytes);
    for (std::size_t cut = 0; cut < cuts; ++cut) {
      feed(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() * cut / cuts)));
    }
    std::mt19937_64 random(bytes.size());
    for (std::size_t round = 0; round < rounds; ++round) feed(mutated(bytes, random));
    fed += 1 + cuts + rounds;
  }
  std::printf("%zu inputs replayed\n", fed);
  return fed ? 0 : 1;
}
