#include "stats/base/file_hash.hpp"

#include <sodium.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "stats/base/error.hpp"

namespace base {

std::string sha256_of_file(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), &std::fclose);
  const auto fail = [&] {
    throw Error(path.string(), std::string("cannot be read: ") + std::strerror(errno),
                "check its permissions and the disk");
  };
  if (!file) fail();
  crypto_hash_sha256_state state;
  crypto_hash_sha256_init(&state);
  std::array<unsigned char, 1 << 16> part{};
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), file.get()))
    crypto_hash_sha256_update(&state, part.data(), n);
  if (std::ferror(file.get()) != 0) fail();
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256_final(&state, digest.data());
  std::array<char, 2 * crypto_hash_sha256_BYTES + 1> text{};
  sodium_bin2hex(text.data(), text.size(), digest.data(), digest.size());
  return text.data();
}

}  // namespace base
