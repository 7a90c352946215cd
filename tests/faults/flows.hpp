#pragma once
/// The commands of vip-study to try faults on, each with its initial state and its required result.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/faults/content.hpp"

namespace faults {

using Arguments = std::vector<std::string>;

struct Flow {
  std::string name;
  /// Puts the command's initial files into an empty folder.
  std::function<void(const fs::path& folder)> prepare;
  /// The command to inject faults into.
  std::function<Arguments(const fs::path& folder)> command;
  /// What a user types after a fault; called again after each fault.
  std::function<Arguments(const fs::path& folder)> again;
  /// Content that must be the same at the end, with or without a fault.
  std::function<Lines(const fs::path& folder)> content;
  /// Databases of the folder that are intact before the fault. Each must open after it.
  std::vector<std::string> healthy;
  /// Database whose sessions the command plays and whose answers it acknowledges; empty: none.
  std::string played;
  /// If only every n-th call is tried, a flow gets one in `share` kinds of faults, and adjacent flows get
  /// different kinds.
  int share = 2;
};

/// Folder of this program, which has the programs under test.
fs::path program_folder();
Arguments vip_study(const Arguments& more);

/// All flows, in the order of the table that vip-faults prints.
const std::vector<Flow>& all_flows();

/// A short study with pages, personal data, free text, practice and trials.
std::string short_protocol();

}  // namespace faults
