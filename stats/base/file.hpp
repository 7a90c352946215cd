#pragma once
/// Reading and writing of whole files, and the paths of the project's own files. Errors are base::Error and
/// name the path.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace base {

/// Owns a file descriptor and closes it on destruction. A negative descriptor means that no file is open.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

/// Returns the bytes of a regular file. base::Error if the file is missing, unreadable, not regular or larger
/// than max_bytes.
std::string read_file(const std::filesystem::path& path, std::size_t max_bytes);

/// Writes to a temporary file in the same folder and renames it over `path` (NewFile): readers see the old
/// file or the new one, never a part. On failure the temporary file is removed.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Creates a folder and its parents if they are missing; base::Error on failure.
void make_folder(const std::filesystem::path& folder);

/// Path of a file or folder that ships with the project, e.g. "shaders/splat.comp" or
/// "data/scenes/single_dam.toml": in $VIP_SHARE_DIR if that is set, else in ../share/vip-lab beside the
/// program's folder if that folder exists (an installed program), else in the source tree. Does not check
/// that the file exists.
std::filesystem::path resource(const std::string& relative);

/// Returns a user's path as given if it exists, else resource(path) if `path` is relative and that file
/// exists. base::Error otherwise, which names the paths tried.
std::filesystem::path find_input(const std::filesystem::path& path);

/// SHA-256 as 64 hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

/// Version of the project, e.g. "0.1.0".
std::string version();

/// The present time in UTC as ISO 8601 with seconds, e.g. "2026-01-31T12:00:00Z".
std::string utc_now();

/// SHA-256 of a file's bytes as 64 hexadecimal digits, read part by part. base::Error if the file cannot be
/// read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace base
