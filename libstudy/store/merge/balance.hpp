#pragma once
/// Reports how evenly the sessions of a database use their protocols' assignments.

#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// The balance of one protocol. The sessions that count are those of Store::taken_slots().
struct Balance {
  std::string name, version;
  int sessions = 0;                ///< that count
  std::vector<int> sequence_uses;  ///< number of sessions by sequence of groups; one entry: a single order
  std::vector<int> slot_uses;  ///< number of sessions by slot; empty: this program cannot read the protocol
  /// True if some sequence or slot has at least two sessions more than another.
  bool off() const;
};

/// The balance of every protocol with a session that counts, in row order.
std::vector<Balance> read_balance(sqlite::Connection& database);

/// "task1 1.0, 12 sessions: 12 sequences, each used once", without a full stop.
std::string describe(const Balance& balance);

}  // namespace study
