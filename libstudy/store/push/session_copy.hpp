#pragma once
/// What push() reads of a session in a station's file.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/file/sqlite.hpp"

namespace study::pushing {

struct LocalSession {
  std::int64_t id = 0, run_id = 0, protocol_id = 0;
  std::string uid, person, code, protocol_sha256;
  std::int64_t visit = 1;
};
/// All sessions, in the order of planning.
std::vector<LocalSession> read_sessions(sqlite::Connection& file);

struct TableRows {
  const central::Table* table = nullptr;
  std::vector<pg::Row> rows;
};
/// The rows of a table (central::Table::rows), in the form of the centre. id: of session, presentation,
/// protocol or run. uid: session.uid, for tables of a session.
TableRows read_rows(sqlite::Connection& file, const central::Table& table, std::int64_t id = 0,
                    const std::string& uid = {});
std::string digest_of(const std::vector<TableRows>& tables);
/// The place of a column in the rows of a table.
std::size_t place_of(const central::Table& table, const std::string& column);

/// A presentation: its row number in the file, and its number at the centre.
struct Showing {
  std::int64_t id = 0, number = 0;
};

/// The small tables of a session. Row numbers (trial_id, presentation_id, ...) count from 1 in the session,
/// in the order of the file, because a merge into the file gives all rows new numbers in the same order.
/// Changes of permissions stand apart, because copies of a session join theirs.
struct Core {
  std::vector<TableRows> tables;  ///< without permission_change; event without changes of permissions
  TableRows changes, change_events;
  std::vector<Showing> showings;
  std::string sha256;         ///< of all of them
  std::vector<pg::Row> log;   ///< utc, clock_ns, kind and detail of the events in `tables`
  std::int64_t progress = 0;  ///< rows in `tables` and finished presentations: it only grows
};
Core read_core(sqlite::Connection& file, const LocalSession& session);
/// The rows of a large table of one presentation, and how many they are.
TableRows read_large(sqlite::Connection& file, const central::Table& table, const LocalSession& session,
                     const Showing& showing);
std::int64_t count_large(sqlite::Connection& file, const central::Table& table, const Showing& showing);
/// Digest of the first `count` events.
std::string log_digest(const std::vector<pg::Row>& log, std::size_t count);

/// Adds to `base` the changes of permissions of another copy: a change that both have takes the larger of
/// each number, as in merge(). True if `base` changed.
bool join_changes(TableRows& base, const TableRows& other);
/// Likewise events; `next`: the event_id of the first one that is added.
bool join_change_events(TableRows& base, const TableRows& other, std::int64_t next);

}  // namespace study::pushing
