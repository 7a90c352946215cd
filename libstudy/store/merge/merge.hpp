#pragma once
/// Joins the databases of several stations into one.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/withdraw.hpp"

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

/// The result of a merge.
struct Merge {
  std::int64_t sessions = 0;       ///< in the result
  std::int64_t recognised = 0;     ///< further copies of a session, not counted twice
  std::int64_t test_sessions = 0;  ///< among `sessions`: still marked as test data
  /// Codes that several people had: "P07 of station north is P07-north".
  std::vector<std::string> renamed;
  /// Codes of all who withdrew; none of their data are in the result.
  std::vector<std::string> withdrawn;
  /// Data that the tombstones deleted from `into` itself, by code.
  std::vector<std::pair<std::string, Stock>> buried;
  CleanUp beside;  ///< backups, personal data and exports of `into`
  /// Datasets with equal name and version but different texts; they stay separate.
  std::vector<std::string> namesakes;
  std::vector<Balance> balance;               ///< of the result, by protocol
  std::vector<std::string> station_troubles;  ///< why the balance may be off: sentences without a full stop
};

/// Joins `sources` with the content of `into`, in `into`.
///
/// Equal protocol hash = one dataset. A session with several copies counts once, as the copy that went
/// furthest; base::Error if two copies diverged. A code of several people becomes "<code>-<station>" for
/// each, or "<code>-<four hexadecimal digits>" where that is not distinct. A person who withdrew in one
/// database is deleted from all, also from backups and personal data beside `into` and from every registered
/// export. The result does not depend on the order of joining; merging again changes nothing. Sources stay
/// unchanged; `into` changes in one transaction or not at all. That transaction also records the work on
/// other files (chores.hpp), so that a kill loses none of it. Personal data stay at their stations.
/// base::Error, with nothing changed: a source has rows without a parent or rows of one session that point
/// into another, or, unless `incomplete`, lacks rows of its journal.
Merge merge(const std::vector<std::filesystem::path>& sources, const std::filesystem::path& into,
            bool incomplete = false);

}  // namespace study
