#pragma once
/// Joins the databases of several stations into one.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/withdraw.hpp"

namespace study {

/// How evenly the sessions of one protocol use its assignment: the slots (numbered positions in the
/// counterbalancing) that participants get in turn. A slot fixes the groups of cells that its participant
/// sees, their sequence and the order within them, as far as the protocol does not draw these at random. A
/// session counts if its state is open, done or stopped and its mark as test data equals that of the
/// protocol.
struct Balance {
  std::string name, version;
  int sessions = 0;  ///< number of sessions that count
  /// number of sessions that use each sequence of groups; a single entry if there is one sequence or the
  /// groups are random
  std::vector<int> sequence_uses;
  std::vector<int> slot_uses;  ///< number of sessions per slot; empty: this program cannot read the protocol
  /// True if a sequence, or a slot, has at least two sessions more than another.
  bool off() const;
};

/// The balance of every protocol that has a session that counts, in the order of the table `protocol`.
std::vector<Balance> read_balance(sqlite::Connection& database);

/// A balance in words: "task1 1.0, 12 sessions: 12 sequences, each used once", without a full stop.
std::string describe(const Balance& balance);

/// The result of a merge.
struct Merge {
  std::int64_t sessions = 0;       ///< number of sessions in the merged database
  std::int64_t recognised = 0;     ///< number of further copies of these sessions, which were omitted
  std::int64_t test_sessions = 0;  ///< how many of `sessions` are marked as test data
  /// New codes of people whose code several people had: "P07 of station 'north' is P07-north".
  std::vector<std::string> renamed;
  /// Codes of all people who withdrew; none of their data are in the result.
  std::vector<std::string> withdrawn;
  /// Amount of data that the merge deleted from `into` because the person withdrew elsewhere, by code.
  std::vector<std::pair<std::string, Stock>> buried;
  CleanUp beside;  ///< clean-up of the backups, personal data and exports of `into`
  /// Protocols with equal name and version but different texts; their datasets stay separate.
  std::vector<std::string> namesakes;
  std::vector<Balance> balance;               ///< balance of the merged database, by protocol
  std::vector<std::string> station_troubles;  ///< reasons why stations may have used the same slots
};

/// Adds the data of the databases `sources` to the database `into`.
///
/// Sessions under equal protocol hashes form one dataset. Of several copies of a session, only the copy with
/// the most progress is used; base::Error if two copies diverged (apart from permission changes, neither
/// log of events begins with the other), or if a person has two sessions with the same protocol and visit
/// number. If several people have the same code, each gets the code "<code>-<station>". If there is no
/// station, or this code is too long or not distinct, the person gets "<code>-<four hexadecimal digits>".
///
/// A person who withdrew in one database is deleted from the result and from backups and personal data beside
/// `into`, and registered exports with the person are deleted (delete_exports_of_withdrawn()). Personal data
/// stay at their stations.
///
/// The result does not depend on the order of sources; merging again changes nothing. The sources stay
/// unchanged. `into` changes in one transaction or not at all; this transaction also stores the chores for
/// other files (chores.hpp), so that a kill loses none.
///
/// base::Error, with nothing changed, if a source has a row whose parent is missing, or a row that refers to
/// a row of another session. Unless `incomplete`, also if a source lacks rows of its journal of answers.
/// `into` must never lack such rows.
Merge merge(const std::vector<std::filesystem::path>& sources, const std::filesystem::path& into,
            bool incomplete = false);

}  // namespace study
