#pragma once
/// A random history of a study: sessions, changes of consent, withdrawals, merges, exports, backups put back,
/// at three stations whose clocks differ and jump, with kills, power cuts and failing calls in any command. A
/// model in memory knows who decided what; after each command the invariants must hold and the databases must
/// agree with it.

#include <cstdint>
#include <string>
#include <vector>

#include "tests/faults/invariants.hpp"

namespace faults {

/// One command with its fault. Numbers are taken modulo what there is, so that a history stays one when steps
/// are left out.
struct Step {
  enum class Kind { Session, Consent, Withdraw, Merge, Export, BackUp, Restore, Salvage, Resume, Status };
  enum class Fault { None, Kill, Tear, PowerExt4, PowerPosix, Error, Full, FullOn };
  Kind kind = Kind::Session;
  unsigned station = 0, who = 0, choice = 0;
  bool yes = false, other = false;
  Fault fault = Fault::None;
  long at = 0;              ///< number of the call
  unsigned seed = 0;        ///< of what a power cut keeps
  std::int64_t wait_s = 0;  ///< since the step before
  std::int64_t jump_s = 0;  ///< of the station's clock
};

std::vector<Step> make_history(unsigned seed, long number);

/// Stops at the first step after which something is wrong. `told`: the commands in words.
Problems run_history(const std::vector<Step>& steps, const fs::path& folder, std::vector<std::string>& told);

/// Steps are left out as long as something of the same kind is wrong.
std::vector<Step> shrink(std::vector<Step> steps, const fs::path& folder, const Problems& problems);

struct HistoryOptions {
  long count = 100, only = -1;  ///< only: this history alone, in words
  unsigned seed = 1;
  int jobs = 1;
};
/// Prints what failed with its number and the shortest history; returns how many failed.
long try_histories(const HistoryOptions& options);

}  // namespace faults
