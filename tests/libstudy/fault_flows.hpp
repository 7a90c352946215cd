#pragma once
/// The commands that keep data, short enough to try a fault at each call of SQLite.

#include <filesystem>
#include <functional>
#include <vector>

#include "tests/faults/content.hpp"

namespace study::test {

namespace fs = std::filesystem;
using faults::Lines;

/// What faults are tried on. `act` does the work, and when given again what is left of it.
struct Flow {
  const char* name;
  std::function<void(const fs::path&)> prepare;
  std::function<void(const fs::path&)> act;
  std::function<Lines(const fs::path&)> content;
  std::vector<const char*> healthy;  ///< databases that open before and must open afterwards
  const char* played = nullptr;      ///< whose answers are acknowledged in the file "said"
};

/// Sessions, resumes, withdrawals, changes of consent, merges, exports, salvages, upgrades.
std::vector<Flow> all_flows();

}  // namespace study::test
