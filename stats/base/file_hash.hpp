#pragma once
/// SHA-256 of files of any size.

#include <filesystem>
#include <string>

namespace base {

/// SHA-256 of a file's bytes as 64 hexadecimal digits, read part by part. base::Error when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace base
