#pragma once
/// A random history of a study: sessions, changes of consent, withdrawals, merges, exports and restored
/// backups at three stations whose clocks differ and jump, with kills, power cuts and failing calls in any
/// command. A model in memory knows all decisions; after each command the invariants must hold and the
/// databases must agree with the model.

#include <cstdint>
#include <string>
#include <vector>

#include "tests/faults/invariants.hpp"

namespace faults {

/// One command with its fault. Numbers are taken modulo the number of choices, so that a history stays valid
/// when steps are left out.
struct Step {
  enum class Kind { Session, Consent, Withdraw, Merge, Export, BackUp, Restore, Salvage, Resume, Status };
  enum class Fault { None, Kill, Tear, PowerExt4, PowerPosix, Error, Full, FullOn };
  Kind kind = Kind::Session;
  unsigned station = 0, who = 0, choice = 0;
  bool yes = false, other = false;
  Fault fault = Fault::None;
  long at = 0;              ///< number of the call that the fault hits
  unsigned seed = 0;        ///< chooses which unsynced calls a power cut keeps
  std::int64_t wait_s = 0;  ///< time since the previous step
  std::int64_t jump_s = 0;  ///< jump of the station's clock
};

std::vector<Step> make_history(unsigned seed, long number);

/// Stops after the first step with a problem. `told`: the commands as text.
Problems run_history(const std::vector<Step>& steps, const fs::path& folder, std::vector<std::string>& told);

/// Leaves out steps, faults and clock jumps as long as a problem of the same kind remains.
std::vector<Step> shrink(std::vector<Step> steps, const fs::path& folder, const Problems& problems);

struct HistoryOptions {
  long count = 100, only = -1;  ///< only: runs this history alone and prints its steps
  unsigned seed = 1;
  int jobs = 1;
};
/// Prints each failed history with its number and its shortest form; returns the number of failures.
long try_histories(const HistoryOptions& options);

}  // namespace faults
