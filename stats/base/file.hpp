#pragma once
/// Whole files in and out, and where the project's own files lie. Errors are base::Error and name the path.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace base {

/// The bytes of a regular file; an error when it is missing, unreadable or larger than max_bytes.
std::string read_file(const std::filesystem::path& path, std::size_t max_bytes);

/// Writes to a neighbour of a name of its own and puts it in place (NewFile): readers see the old file or the
/// new, never a part. Nothing is left beside `path` when that fails.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// A file or folder that ships with the project, e.g. "shaders/splat.comp" or "data/scenes/single_dam.toml".
/// In $VIP_SHARE_DIR when that is set, else in <program>/../share/vip-lab when that folder is there (an
/// installed program), else in the source tree. Whether the file exists is not asked.
std::filesystem::path resource(const std::string& relative);

/// A user's path as given when it exists, otherwise resource(path) when that exists, otherwise an error that
/// names both.
std::filesystem::path find_input(const std::filesystem::path& path);

/// SHA-256 as 64 hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

/// Version of the project, e.g. "0.1.0".
std::string version();

/// Now in UTC as ISO 8601 with seconds, e.g. "2026-01-31T12:00:00Z".
std::string utc_now();

}  // namespace base
