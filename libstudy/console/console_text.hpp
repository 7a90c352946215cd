#pragma once
/// The time of day, the steady clock and the free disk space, for the console's lines.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "stats/base/file.hpp"

namespace study {

/// The current time in UTC, such as "14:03:05".
inline std::string clock_time() { return base::utc_now().substr(11, 8); }

inline std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Free space on the disk of the database's folder, MB; negative: not known.
inline double free_mb(const std::filesystem::path& database) {
  std::error_code error;
  const auto space = std::filesystem::space(std::filesystem::absolute(database).parent_path(), error);
  return error ? -1 : 1e-6 * static_cast<double>(space.available);
}

}  // namespace study
