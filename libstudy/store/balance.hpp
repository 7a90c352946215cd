#pragma once
/// How evenly the sessions of a database use the assignment of their protocols.

#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// Of one protocol. Sessions that count are those of Store::taken_slots().
struct Balance {
  std::string name, version;
  int sessions = 0;                ///< that count
  std::vector<int> sequence_uses;  ///< by sequence of groups: by how many sessions; one entry: a single order
  std::vector<int> slot_uses;      ///< by slot: likewise; empty: this program cannot read the protocol
  /// Some sequence or slot is used by at least two sessions more than another.
  bool off() const;
};

/// Of every protocol with a session that counts, in the order of the rows.
std::vector<Balance> read_balance(sqlite::Connection& database);

/// "task1 1.0, 12 sessions: 12 sequences, each used once", without a full stop.
std::string describe(const Balance& balance);

}  // namespace study
