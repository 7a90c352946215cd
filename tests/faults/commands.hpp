#pragma once
/// Each command that stores data, small enough to try every state that a power cut may leave. Each works in
/// stations: folders with a database "s.db" and the files beside it.

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
  Work prepare;  ///< makes the stations in an empty folder
  Work act;
  Work again;  ///< the command that a user types after a fault; null: act
  Work other;  ///< another command that a user may type instead of `again`; null: resume in each station
  std::vector<std::string> stations;  ///< stations to check afterwards
  /// People who have withdrawn when the command is done, by station.
  std::map<std::string, std::vector<Person>> gone{};
  /// People who have withdrawn when `other` is done, by station. People whose withdrawal the database records
  /// (by a row of the table tombstone) count without being listed here.
  std::map<std::string, std::vector<Person>> gone_by_other{};
  /// People whose permission the command grants. After a fault both answers are valid, until a command has
  /// opened the database for writing.
  std::set<std::string> allowed{};
  bool refuses = false;  ///< the command must be refused and change nothing
  bool is_read = true;   ///< exports can be made from the stations right after the fault
};

const std::vector<Command>& all_commands();

/// The people who take part in the commands.
extern const Person anna, ben, cleo, dora;

}  // namespace faults
