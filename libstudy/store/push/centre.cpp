#include "libstudy/store/push/centre.hpp"

#include "libstudy/store/permissions.hpp"
#include "stats/base/error.hpp"

namespace study::pushing {

using central::Table;
using pg::Row;

namespace {

std::vector<pg::ColumnType> types_of(const Table& table) {
  std::vector<pg::ColumnType> types;
  for (const central::Column& column : table.columns) types.push_back({column.name, column.type});
  return types;
}

}  // namespace

std::string at_centre(const Table& table) { return "vip." + pg::quoted_name(table.name); }

Centre::Centre(const std::string& service) : connection_(service) {
  const std::int64_t number = connection_.run("SELECT number FROM vip.schema_version").integer(0, 0);
  const std::int64_t own = central::schema_number();
  if (number == own) return;
  throw base::Error(
      "service " + service,
      "its database has the schema " + std::to_string(number) + ", this program " + std::to_string(own),
      number < own ? "let its owner upgrade it: vip-study central upgrade --service NAME"
                   : "use the newer vip-study that upgraded it");
}

void Centre::take_turn() {
  // A client that was killed or cut off holds the lock until the server notices: within half a minute.
  connection_.script(
      "SET tcp_keepalives_idle = 15; SET tcp_keepalives_interval = 5; SET tcp_keepalives_count = 3; "
      "SET tcp_user_timeout = 30000; SET idle_in_transaction_session_timeout = '10min'; "
      "SET lock_timeout = '60s'");
  try {
    connection_.run("SELECT pg_advisory_lock(hashtextextended('push ' || session_user, 2))");
  } catch (const pg::Failure& failure) {
    if (failure.sqlstate() != "55P03") throw;
    throw base::Error("service " + connection_.service(),
                      "another push of this station has not ended for a minute",
                      "wait until it ends, then give the command again");
  }
  connection_.script("SET lock_timeout = 0");
}

std::set<std::string> Centre::withdrawn_among(const std::set<std::string>& people) {
  std::vector<Row> rows;
  for (const std::string& person : people) rows.push_back({person});
  const auto found =
      connection_.run("SELECT * FROM vip.withdrawn_among($1::text[])", {pg::array_of(rows, 0)});
  std::set<std::string> gone;
  for (int i = 0; i < found.size(); ++i) gone.insert(found.text(i, 0));
  return gone;
}

Ledger Centre::read_ledger() {
  const auto rows = connection_.run(
      "SELECT of, part, sha256, rows, coalesce(events, 0), coalesce(progress, 0), coalesce(log_sha256, '') "
      "FROM vip.part WHERE true" +
      and_mine);
  Ledger ledger;
  for (int i = 0; i < rows.size(); ++i)
    ledger[rows.text(i, 0)][rows.text(i, 1)] = {rows.text(i, 2), rows.integer(i, 3), rows.integer(i, 4),
                                                rows.integer(i, 5), rows.text(i, 6)};
  return ledger;
}

void Centre::note(const std::string& of, const Parts& parts) {
  std::vector<Row> rows;
  for (const auto& [name, part] : parts)
    rows.push_back({of, name, part.sha256, pg::text_of(part.rows), pg::text_of(part.events),
                    pg::text_of(part.progress), part.log_sha256});
  connection_.insert("vip.part",
                     {{"of", "text"},
                      {"part", "text"},
                      {"sha256", "text"},
                      {"rows", "bigint"},
                      {"events", "bigint"},
                      {"progress", "bigint"},
                      {"log_sha256", "text"}},
                     rows,
                     "ON CONFLICT (of, sender, part) DO UPDATE SET sha256 = excluded.sha256, rows = "
                     "excluded.rows, events = excluded.events, progress = excluded.progress, log_sha256 = "
                     "excluded.log_sha256, pushed_utc = now()");
}

std::int64_t Centre::insert(const TableRows& rows, const std::string& tail) {
  return connection_.insert(at_centre(*rows.table), types_of(*rows.table), rows.rows, tail);
}

std::vector<Row> Centre::log(const std::string& uid, std::int64_t count) {
  const auto rows = connection_.run(
      "SELECT utc, clock_ns, kind, detail FROM vip.event WHERE session_uid = $1 AND kind <> $2" + and_mine +
          " ORDER BY event_id LIMIT $3",
      {uid, permission_event, pg::text_of(count)});
  std::vector<Row> log;
  for (int i = 0; i < rows.size(); ++i)
    log.push_back({rows.at(i, 0), rows.at(i, 1), rows.at(i, 2), rows.at(i, 3)});
  return log;
}

TableRows Centre::rows(const Table& table, const std::string& uid, const std::string& condition) {
  const auto rows = connection_.run("SELECT " + central::column_list(table) + " FROM " + at_centre(table) +
                                        " WHERE session_uid = $1" + condition + and_mine + " ORDER BY 1, 2",
                                    {uid});
  TableRows found{&table, {}};
  for (int i = 0; i < rows.size(); ++i) {
    Row& row = found.rows.emplace_back();
    for (std::size_t j = 0; j < table.columns.size(); ++j) row.push_back(rows.at(i, static_cast<int>(j)));
  }
  return found;
}

TableRows Centre::changes(const std::string& uid) {
  return rows(central::table("permission_change"), uid, "");
}

TableRows Centre::change_events(const std::string& uid) {
  return rows(central::table("event"), uid, " AND kind = " + pg::quoted_text(permission_event));
}

}  // namespace study::pushing
