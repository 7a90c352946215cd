#pragma once
/// Each command that keeps data, small enough to try every state that a power cut may leave of it. Each works
/// in stations: folders with a database "s.db" and all that stands beside it.

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/faults/small_study.hpp"

namespace faults {

struct Command {
  using Work = std::function<void(const fs::path& folder)>;
  std::string name;
  Work prepare;  ///< into an empty folder
  Work act;
  Work again;  ///< what a user types after a fault; null: act
  Work other;  ///< what may come instead of it: another command; null: resume in each station
  std::vector<std::string> stations;  ///< which are looked at afterwards
  /// Who has withdrawn once it is done, by station.
  std::map<std::string, std::vector<Person>> gone{};
  /// Likewise once `other` is done; what holds in any case is found in tombstones.
  std::map<std::string, std::vector<Person>> gone_by_other{};
  /// Whose permission the command gives; until it is settled, either answer holds.
  std::set<std::string> allowed{};
  bool refuses = false;  ///< the command must be refused, and nothing changed
  bool is_read = true;   ///< exports can be made of the stations before the command is given again
};

const std::vector<Command>& all_commands();

/// Takes part in all of them.
extern const Person anna, ben, cleo, dora;

}  // namespace faults
