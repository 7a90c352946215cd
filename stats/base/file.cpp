#include "stats/base/file.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "stats/base/error.hpp"
#include "stats/base/new_file.hpp"

namespace base {

namespace fs = std::filesystem;

namespace {

std::string reason() { return std::strerror(errno); }

}  // namespace

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

// Opens with O_NONBLOCK: opening a named pipe that has no writer would otherwise block.
std::string read_file(const fs::path& path, std::size_t max_bytes) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0)
    throw Error(path.string(), "cannot be read: " + reason(), "check the path and its permissions");
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
    throw Error(path.string(), "is not a regular file", "give the path of a file");
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > max_bytes) {
    throw Error(
        path.string(),
        "holds " + std::to_string(size) + " bytes, at most " + std::to_string(max_bytes) + " are read",
        "name the right file");
  }
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n = ::read(file.get(), bytes.data() + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Error(path.string(), "cannot be read: " + reason(), "check the disk");
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

void write_file_atomically(const fs::path& path, std::string_view bytes) {
  NewFile file(path);
  file.write(bytes);
  file.put_in_place();
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw Error(folder.string(), "cannot be made a folder: " + error.message(), "choose another folder");
  }
}

fs::path resource(const std::string& relative) {
  if (const char* share = std::getenv("VIP_SHARE_DIR")) return fs::path(share) / relative;
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path installed = program.parent_path().parent_path() / "share" / "vip-lab";
  // An installed program uses only its own files, even if a source tree exists.
  if (!program.empty() && fs::is_directory(installed, ignored)) return installed / relative;
  return fs::path(VIP_SOURCE_DIR) / relative;
}

fs::path find_input(const fs::path& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) return path;
  const fs::path shipped = path.is_relative() ? resource(path.string()) : path;
  if (fs::exists(shipped, ignored)) return shipped;
  throw Error(path.string(), "does not exist",
              path.is_relative() ? "check the path (also looked for at " + shipped.string() + ")"
                                 : std::string("check the path"));
}

std::string sha256_hex(std::string_view bytes) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  std::array<char, 2 * crypto_hash_sha256_BYTES + 1> text{};
  sodium_bin2hex(text.data(), text.size(), digest.data(), digest.size());
  return text.data();
}

std::string version() { return VIP_VERSION; }

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
