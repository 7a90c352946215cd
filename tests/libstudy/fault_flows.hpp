#pragma once
/// The commands that store data, in versions short enough to inject a fault at each call of SQLite.

#include <filesystem>
#include <functional>
#include <vector>

#include "tests/faults/content.hpp"

namespace study::test {

namespace fs = std::filesystem;
using faults::Lines;

/// One command to inject faults into. `act` does the work; a second call finishes the rest.
struct Flow {
  const char* name;
  std::function<void(const fs::path&)> prepare;
  std::function<void(const fs::path&)> act;
  std::function<Lines(const fs::path&)> content;
  std::vector<const char*> healthy;  ///< databases that open before and must still open afterwards
  const char* played = nullptr;      ///< database whose acknowledged answers are listed in the file "said"
};

/// Sessions, resumes, withdrawals, changes of consent, merges, exports, salvages, upgrades.
std::vector<Flow> all_flows();

}  // namespace study::test
