#pragma once
/// Tries the states that a kill or a power cut may leave of a command: each is made, checked, and continued
/// in two ways, by another command and by the same one. The invariants must hold throughout, and the final
/// state must equal that without a fault.

#include <filesystem>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "tests/faults/child.hpp"
#include "tests/faults/commands.hpp"
#include "tests/faults/crash_states.hpp"
#include "tests/faults/invariants.hpp"

namespace faults {

/// One state to try.
struct CrashTry {
  std::size_t count = 0;  ///< number of calls made before the fault
  Model model = Model::Ext4;
  Kept kept = Kept::Least;
  unsigned seed = 0;
  std::string text() const;
};

class Crashes {
 public:
  /// Prepares the command in `folder`, which only this object may use, and records its calls.
  Crashes(const Command& command, const fs::path& folder);

  /// Problems that were found when the command ran without a fault.
  const Problems& at_first() const { return at_first_; }
  /// Number of recorded calls and texts.
  std::size_t calls() const { return recorded_.calls.size(); }
  /// The last call before a fault, for messages.
  std::string last_call(const CrashTry& one) const;
  /// Makes the state. Returns false if an equal state was made before.
  bool make(const CrashTry& one);
  /// Continues in both ways from the state that was made last; returns the problems.
  Problems go_on();

 private:
  using Gone = std::map<std::string, std::vector<Person>>;
  Ended run(const std::function<void(const fs::path&)>& work);
  struct When {
    std::string name;
    bool exports = true;  ///< exports may be made now
    bool settled = true;  ///< the database was opened for writing since the fault
  };
  void check(const When& when, const Gone& gone, Problems& problems);
  std::vector<std::string> described(Problems& problems);
  void try_again(Problems& problems);

  const Command& command_;
  fs::path now_, peek_;
  CallLog log_;
  Tree before_, state_;
  Ended recorded_;
  Problems at_first_;
  std::vector<std::string> wanted_;
  std::set<std::pair<std::string, int>> acknowledged_before_, acknowledged_;
  std::unordered_set<std::size_t> seen_;
};

/// Adds to `all` the units that records "done <key> <position>" (small_study.hpp) among the first `count`
/// calls name.
void take_acknowledged(const std::vector<Call>& calls, std::size_t count,
                       std::set<std::pair<std::string, int>>& all);

struct CrashOptions {
  std::vector<std::string> commands;  ///< empty: all
  int jobs = 1;
  long every = 1;  ///< tries only every n-th call
  int seeds = 2;   ///< random states for each call and model
  long kills = 0;  ///< 0: every call; otherwise this many random calls, each with one state of each model
  unsigned seed = 1;
};
/// Prints a table and the failures; returns the number of failures.
long try_crashes(const CrashOptions& options);

}  // namespace faults
