#pragma once
/// The commands of vip-study that faults are tried on, each with what it starts from and what it must come
/// to.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/faults/content.hpp"

namespace faults {

using Arguments = std::vector<std::string>;

struct Flow {
  std::string name;
  /// Puts into an empty folder all that the command starts from.
  std::function<void(const fs::path& folder)> prepare;
  /// The command that faults fall into.
  std::function<Arguments(const fs::path& folder)> command;
  /// What a user types after a fault; asked anew after each.
  std::function<Arguments(const fs::path& folder)> again;
  /// What must be the same in the end, with a fault and without.
  std::function<Lines(const fs::path& folder)> content;
  /// Databases of the folder that are healthy before and must open whatever happens.
  std::vector<std::string> healthy;
  /// Database whose sessions the command plays, and whose answers it acknowledges; empty: none.
  std::string played;
};

/// Folder of the programs under test: that of this program.
fs::path program_folder();
Arguments vip_study(const Arguments& more);

/// All of them, in the order of the table.
const std::vector<Flow>& all_flows();

/// A short study with pages, personal data, words, practice and trials.
std::string short_protocol();

}  // namespace faults
