#pragma once
/// What push() and pull say to the central database: the statements of a station.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/push/session_copy.hpp"

namespace study::pushing {

/// A row of the ledger vip.part: what stands at the centre of one part of a file.
struct Part {
  std::string sha256;
  std::int64_t rows = 0;
  std::int64_t events = 0, progress = 0;  ///< of the part "core" of a session (Core)
  std::string log_sha256 = {};            ///< likewise: digest of these events
};
/// The parts by name: "core", or a large table and a presentation_id.
using Parts = std::map<std::string, Part>;
/// By session.uid, protocol.sha256 or "labels".
using Ledger = std::map<std::string, Parts>;

/// Ends every condition of a statement: the rows that this role sent. The policies of the server say the
/// same.
inline const std::string and_mine = " AND sender = session_user::text";

std::string at_centre(const central::Table& table);

/// The central database as a station sees it.
class Centre {
 public:
  /// base::Error unless the centre has the schema of this program.
  explicit Centre(const std::string& service);
  pg::Connection& connection() { return connection_; }
  /// One push at a time for each role: a second one waits. base::Error after a minute.
  void take_turn();
  /// Which of these people withdrew.
  std::set<std::string> withdrawn_among(const std::set<std::string>& people);
  Ledger read_ledger();
  /// Writes parts into the ledger.
  void note(const std::string& of, const Parts& parts);
  /// Inserts rows; returns how many.
  std::int64_t insert(const TableRows& rows, const std::string& tail = "");
  /// The first `count` events of a session without changes of permissions, as Core::log.
  std::vector<pg::Row> log(const std::string& uid, std::int64_t count);
  TableRows changes(const std::string& uid);
  TableRows change_events(const std::string& uid);

 private:
  TableRows rows(const central::Table& table, const std::string& uid, const std::string& condition);

  pg::Connection connection_;
};

}  // namespace study::pushing
