#pragma once
/// Prints the result of a clean-up after a withdrawal or a merge.

#include <cstdio>
#include <string>
#include <vector>

#include "libstudy/store/chores.hpp"

namespace apps {

inline void print_list(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  std::printf("%s\n", title);
  for (const std::string& line : lines) std::printf("  %s\n", line.c_str());
}

/// Prints what is missing in a study that is read with --incomplete.
inline void print_lacking(const std::filesystem::path& database, const std::string& lacking) {
  if (!lacking.empty()) std::printf("%s is incomplete: %s\n", database.c_str(), lacking.c_str());
}

inline void print_clean_up(const study::CleanUp& done) {
  for (const auto& path : done.cleaned) {
    std::error_code ignored;
    const bool stands = std::filesystem::exists(path, ignored);
    std::printf(stands ? "cleaned as well: %s\n" : "deleted, make it again: %s\n", path.c_str());
  }
  print_list("Still left:", done.left);
}

}  // namespace apps
