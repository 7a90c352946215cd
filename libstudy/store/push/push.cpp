#include "libstudy/store/push/push.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/push/session_copy.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

using central::Table;
using pg::Row;
using pushing::Core;
using pushing::LocalSession;
using pushing::TableRows;

namespace {

constexpr const char* person_withdrew = "VP001";  // sql/central.sql
// Rows of large tables that one transaction sends at most, apart from those of its last presentation.
constexpr std::size_t rows_at_once = 20000;
const std::string mine = " AND sender = session_user::text";

/// A session that the centre does not take.
class Diverged : public base::Error {
  using Error::Error;
};

/// A row of the ledger vip.part.
struct Part {
  std::string sha256, log_sha256;
  std::int64_t rows = 0, events = 0, progress = 0;
};
using Parts = std::map<std::string, Part>;

std::vector<pg::ColumnType> types_of(const Table& table) {
  std::vector<pg::ColumnType> types;
  for (const central::Column& column : table.columns) types.push_back({column.name, column.type});
  return types;
}

std::string at_centre(const Table& table) { return "vip." + pg::quoted_name(table.name); }

/// People as the text of a PostgreSQL array.
std::string array_of_people(const std::set<std::string>& people) {
  std::string out = "{";
  for (const std::string& person : people) {
    out += out.size() > 1 ? ",\"" : "\"";
    for (const char c : person) {
      if (c == '"' || c == '\\') out += '\\';
      out += c;
    }
    out += '"';
  }
  return out + "}";
}

void check_schema_number(pg::Connection& centre) {
  const std::int64_t number = centre.run("SELECT number FROM vip.schema_version").integer(0, 0);
  const std::int64_t own = central::schema_number();
  if (number == own) return;
  throw base::Error(
      "service " + centre.service(),
      "its database has the schema " + std::to_string(number) + ", this program " + std::to_string(own),
      number < own ? "let its owner upgrade it: vip-study central upgrade --service NAME"
                   : "use the newer vip-study that upgraded it");
}

std::set<std::string> withdrawn_among(pg::Connection& centre, const std::set<std::string>& people) {
  const auto rows = centre.run("SELECT * FROM vip.withdrawn_among($1::text[])", {array_of_people(people)});
  std::set<std::string> found;
  for (int i = 0; i < rows.size(); ++i) found.insert(rows.text(i, 0));
  return found;
}

/// One push at a time for each role: a second one waits. A client that was killed or cut off holds the lock
/// until the server notices, for which the settings give it half a minute.
void take_turn(pg::Connection& centre) {
  centre.script(
      "SET tcp_keepalives_idle = 15; SET tcp_keepalives_interval = 5; SET tcp_keepalives_count = 3; "
      "SET tcp_user_timeout = 30000; SET idle_in_transaction_session_timeout = '10min'; "
      "SET lock_timeout = '60s'");
  try {
    centre.run("SELECT pg_advisory_lock(hashtextextended('push ' || session_user, 2))");
  } catch (const pg::Failure& failure) {
    if (failure.sqlstate() != "55P03") throw;
    throw base::Error("service " + centre.service(),
                      "another push of this station has not ended for a minute",
                      "wait until it ends, then give the command again");
  }
  centre.script("SET lock_timeout = 0");
}

/// A transaction of the file, so that all that is read of a session belongs together.
class Reading {
 public:
  explicit Reading(sqlite::Connection& file) : file_(&file) { file.execute("BEGIN"); }
  ~Reading() {
    try {
      file_->execute("COMMIT");
    } catch (const std::exception&) {
      // Nothing was written, so that nothing is lost.
    }
  }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

 private:
  sqlite::Connection* file_;
};

class Pusher {
 public:
  Pusher(sqlite::Connection& file, const std::string& service) : file_(file), centre_(service) {
    check_schema_number(centre_);
    take_turn(centre_);
  }

  Push push(const std::function<void(std::int64_t, std::int64_t)>& told) {
    push_tombstones();
    const auto sessions = pushing::read_sessions(file_);
    std::set<std::string> people;
    for (const LocalSession& session : sessions) people.insert(session.person);
    withdrawn_ = withdrawn_among(centre_, people);
    read_ledger();
    done_.sessions = static_cast<std::int64_t>(sessions.size());
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      if (told) told(static_cast<std::int64_t>(i), done_.sessions);
      try_session(sessions[i]);
    }
    push_labels();
    done_.bytes = centre_.bytes_sent();
    return done_;
  }

 private:
  void push_tombstones() {
    const Table& table = central::table("tombstone");
    const auto known = centre_.run("SELECT person FROM vip.tombstone WHERE true" + mine);
    std::set<std::string> there;
    for (int i = 0; i < known.size(); ++i) there.insert(known.text(i, 0));
    const std::size_t person = pushing::place_of(table, "person");
    for (const Row& row : pushing::read_rows(file_, table).rows) {
      if (there.contains(*row[person])) continue;
      // One at a time: each waits for the transactions about its person.
      done_.tombstones += centre_.insert(at_centre(table), types_of(table), {row}, "ON CONFLICT DO NOTHING");
    }
  }

  void read_ledger() {
    const auto rows = centre_.run(
        "SELECT of, part, sha256, rows, coalesce(events, 0), coalesce(log_sha256, ''), coalesce(progress, 0) "
        "FROM vip.part WHERE true" +
        mine);
    for (int i = 0; i < rows.size(); ++i) {
      ledger_[rows.text(i, 0)][rows.text(i, 1)] = {rows.text(i, 2), rows.text(i, 5), rows.integer(i, 3),
                                                   rows.integer(i, 4), rows.integer(i, 6)};
    }
  }

  void note_part(const std::string& of, const std::string& name, const Part& part) {
    centre_.run(
        "INSERT INTO vip.part (of, part, sha256, rows, events, log_sha256, progress) VALUES ($1, $2, $3, $4, "
        "$5, $6, $7) ON CONFLICT (of, sender, part) DO UPDATE SET sha256 = excluded.sha256, rows = "
        "excluded.rows, events = excluded.events, log_sha256 = excluded.log_sha256, progress = "
        "excluded.progress, pushed_utc = now()",
        {of, name, part.sha256, pg::text_of(part.rows), pg::text_of(part.events), part.log_sha256,
         pg::text_of(part.progress)});
  }

  void insert(const TableRows& rows, const std::string& tail = "") {
    done_.rows += centre_.insert(at_centre(*rows.table), types_of(*rows.table), rows.rows, tail);
  }

  /// Sends a session; what the centre refuses of it is noted, and the next session follows.
  void try_session(const LocalSession& session) {
    if (withdrawn_.contains(session.person)) {
      ++done_.withdrawn;
      return;
    }
    const std::string name = "participant " + session.code + ", visit " + std::to_string(session.visit);
    try {
      push_session(session);
    } catch (const pg::Failure& failure) {
      if (failure.lost()) throw;
      ledger_.erase(session.uid);
      if (failure.sqlstate() == person_withdrew || is_withdrawn(session.person))
        ++done_.withdrawn;
      else
        done_.refused.push_back(name + ": " + failure.what());
    } catch (const Diverged& error) {
      done_.refused.push_back(name + ": " + error.what());
    }
  }

  /// True if the person withdrew since the push began.
  bool is_withdrawn(const std::string& person) {
    if (!withdrawn_among(centre_, {person}).contains(person)) return false;
    withdrawn_.insert(person);
    return true;
  }

  void push_session(const LocalSession& session) {
    const Reading reading(file_);
    const Core core = pushing::read_core(file_, session);
    const auto known = ledger_.find(session.uid);
    const auto part = known == ledger_.end() ? Parts::iterator() : known->second.find("core");
    const bool there = known != ledger_.end() && part != known->second.end();
    bool sent = false;
    if (there && part->second.sha256 != core.sha256 && is_older(session, core, part->second)) {
      join_older(session, core);
      ++done_.older;
      return;
    }
    if (!there || part->second.sha256 != core.sha256) {
      push_protocol(session);
      replace_core(session, core, there);
      sent = true;
    }
    if (push_large(session)) sent = true;
    if (sent) ++done_.sent;
  }

  /// True if the centre has a later state of the session. Diverged if neither began with the other.
  bool is_older(const LocalSession& session, const Core& core, const Part& there) {
    const auto here = static_cast<std::int64_t>(core.log.size());
    const auto first = static_cast<std::size_t>(std::min(here, there.events));
    const std::string before =
        here < there.events ? pushing::log_digest(log_at_centre(session, here), first) : there.log_sha256;
    if (pushing::log_digest(core.log, first) != before) {
      throw Diverged(file_.path().string(),
                     "the session continued differently in the copy that was pushed before",
                     "decide which of the two counts: push that file alone, or let the owner of the central "
                     "database delete the session there");
    }
    return here < there.events || (here == there.events && core.progress < there.progress);
  }

  std::vector<Row> log_at_centre(const LocalSession& session, std::int64_t count) {
    const auto rows = centre_.run(
        "SELECT utc, clock_ns, kind, detail FROM vip.event WHERE session_uid = $1 AND kind <> $2" + mine +
            " ORDER BY event_id LIMIT $3",
        {session.uid, permission_event, pg::text_of(count)});
    std::vector<Row> log;
    for (int i = 0; i < rows.size(); ++i)
      log.push_back({rows.at(i, 0), rows.at(i, 1), rows.at(i, 2), rows.at(i, 3)});
    log.resize(static_cast<std::size_t>(count));
    return log;
  }

  TableRows rows_at_centre(const Table& table, const std::string& uid, const std::string& condition) {
    const auto rows = centre_.run("SELECT " + central::column_list(table) + " FROM " + at_centre(table) +
                                      " WHERE session_uid = $1" + condition + mine + " ORDER BY 1, 2",
                                  {uid});
    TableRows found{&table, {}};
    for (int i = 0; i < rows.size(); ++i) {
      Row& row = found.rows.emplace_back();
      for (std::size_t j = 0; j < table.columns.size(); ++j) row.push_back(rows.at(i, static_cast<int>(j)));
    }
    return found;
  }
  TableRows changes_at_centre(const std::string& uid) {
    return rows_at_centre(central::table("permission_change"), uid, "");
  }
  TableRows change_events_at_centre(const std::string& uid) {
    return rows_at_centre(central::table("event"), uid, " AND kind = " + pg::quoted_text(permission_event));
  }

  /// Joins the permissions of an older copy into those at the centre.
  void join_older(const LocalSession& session, const Core& core) {
    pg::Transaction transaction(centre_);
    TableRows changes = changes_at_centre(session.uid), events = change_events_at_centre(session.uid);
    const std::int64_t last =
        centre_
            .run("SELECT coalesce(max(event_id), 0) FROM vip.event WHERE session_uid = $1" + mine,
                 {session.uid})
            .integer(0, 0);
    const bool changed = pushing::join_changes(changes, core.changes);
    const bool told = pushing::join_change_events(events, core.change_events, last + 1);
    if (!changed && !told) return;
    const std::string of = " WHERE session_uid = $1" + mine;
    centre_.run("DELETE FROM vip.permission_change" + of, {session.uid});
    centre_.run("DELETE FROM vip.event" + of + " AND kind = $2", {session.uid, permission_event});
    insert(changes);
    insert(events);
    centre_.run("SELECT vip.drop_refused_gaze($1)", {session.uid});
    transaction.commit();
  }

  void push_protocol(const LocalSession& session) {
    std::vector<TableRows> tables;
    for (const Table* table : central::in_order()) {
      if (table->scope == central::Scope::Protocol)
        tables.push_back(pushing::read_rows(file_, *table, session.protocol_id));
    }
    Part part{pushing::digest_of(tables), "", 0, 0, 0};
    const auto known = ledger_.find(session.protocol_sha256);
    if (known != ledger_.end() && known->second["core"].sha256 == part.sha256) return;
    pg::Transaction transaction(centre_);
    for (const TableRows& rows : tables) {
      insert(rows, "ON CONFLICT DO NOTHING");
      part.rows += static_cast<std::int64_t>(rows.rows.size());
    }
    note_part(session.protocol_sha256, "core", part);
    transaction.commit();
    ledger_[session.protocol_sha256]["core"] = part;
  }

  /// Replaces the small tables of a session. there: the centre has some.
  void replace_core(const LocalSession& session, const Core& core, bool there) {
    TableRows changes = core.changes, events = core.change_events;
    pg::Transaction transaction(centre_);
    if (there) {
      pushing::join_changes(changes, changes_at_centre(session.uid));
      pushing::join_change_events(events, change_events_at_centre(session.uid), next_event(core));
      std::string sql;
      for (const Table& table : central::tables()) {
        if (table.scope == central::Scope::Session && !table.large)
          sql += "DELETE FROM " + at_centre(table) + " WHERE session_uid = " + pg::quoted_text(session.uid) +
                 mine + ";";
      }
      centre_.script(sql);
    }
    insert(pushing::read_rows(file_, central::table("run"), session.run_id), "ON CONFLICT DO NOTHING");
    Part part{core.sha256, pushing::log_digest(core.log, core.log.size()), 0,
              static_cast<std::int64_t>(core.log.size()), core.progress};
    for (const TableRows& rows : core.tables) {
      insert(rows);
      part.rows += static_cast<std::int64_t>(rows.rows.size());
    }
    insert(changes);
    insert(events);
    note_part(session.uid, "core", part);
    if (!changes.rows.empty()) centre_.run("SELECT vip.drop_refused_gaze($1)", {session.uid});
    transaction.commit();
  }

  /// An event_id after all events of a session.
  static std::int64_t next_event(const Core& core) {
    std::int64_t last = 0;
    const auto look = [&](const TableRows& rows) {
      const std::size_t id = pushing::place_of(*rows.table, "event_id");
      for (const Row& row : rows.rows) last = std::max(last, static_cast<std::int64_t>(std::stoll(*row[id])));
    };
    for (const TableRows& rows : core.tables) {
      if (rows.table->name == "event") look(rows);
    }
    look(core.change_events);
    return last + 1;
  }

  /// Parts of large tables that wait for a transaction.
  struct Waiting {
    std::map<const Table*, TableRows> rows;
    std::map<std::string, Part> parts;
    std::string deletions;
    std::size_t count = 0;
  };

  /// Sends the large tables of a session, a part for each presentation. True if something was sent.
  bool push_large(const LocalSession& session) {
    std::vector<std::int64_t> presentations;
    sqlite::Statement row(file_,
                          "SELECT presentation_id FROM presentation JOIN trial USING (trial_id) WHERE "
                          "session_id = ? ORDER BY presentation_id");
    for (row.bind_all(session.id); row.step();) presentations.push_back(row.integer(0));
    bool sent = false;
    Waiting waiting;
    for (const std::int64_t presentation : presentations) {
      for (const Table& table : central::tables())
        if (table.large) add_part(session, table, presentation, waiting);
      if (waiting.count > rows_at_once) sent = send_parts(session, waiting) || sent;
    }
    return send_parts(session, waiting) || sent;
  }

  void add_part(const LocalSession& session, const Table& table, std::int64_t presentation,
                Waiting& waiting) {
    TableRows rows = pushing::read_rows(file_, table, presentation, session.uid);
    const std::string name = table.name + " " + std::to_string(presentation);
    const Parts& parts = ledger_[session.uid];
    const auto known = parts.find(name);
    const auto count = static_cast<std::int64_t>(rows.rows.size());
    // Fewer rows: an older copy, or gaze that is refused, which the centre deletes by itself.
    if (count == 0 || (known != parts.end() && count < known->second.rows)) return;
    const std::string sha256 = pushing::digest_of({rows});
    if (known != parts.end()) {
      if (known->second.sha256 == sha256) return;
      waiting.deletions += "DELETE FROM " + at_centre(table) +
                           " WHERE session_uid = " + pg::quoted_text(session.uid) + mine +
                           " AND presentation_id = " + std::to_string(presentation) + ";";
    }
    waiting.parts[name] = {sha256, "", count, 0, 0};
    waiting.count += rows.rows.size();
    TableRows& all = waiting.rows[&table];
    all.table = &table;
    std::move(rows.rows.begin(), rows.rows.end(), std::back_inserter(all.rows));
  }

  /// Sends the parts that wait, in one transaction. False if there are none.
  bool send_parts(const LocalSession& session, Waiting& waiting) {
    if (waiting.parts.empty()) return false;
    pg::Transaction transaction(centre_);
    if (!waiting.deletions.empty()) centre_.script(waiting.deletions);
    bool motion = false;
    for (const auto& [table, rows] : waiting.rows) {
      insert(rows);
      motion = motion || table->name == "gaze" || table->name == "head";
    }
    std::vector<Row> parts;
    for (const auto& [name, part] : waiting.parts)
      parts.push_back({session.uid, name, part.sha256, pg::text_of(part.rows)});
    centre_.insert(
        "vip.part", {{"of", "text"}, {"part", "text"}, {"sha256", "text"}, {"rows", "bigint"}}, parts,
        "ON CONFLICT (of, sender, part) DO UPDATE SET sha256 = excluded.sha256, rows = excluded.rows, "
        "pushed_utc = now()");
    if (motion) centre_.run("SELECT vip.drop_refused_gaze($1)", {session.uid});
    transaction.commit();
    for (const auto& [name, part] : waiting.parts) ledger_[session.uid][name] = part;
    waiting = {};
    return true;
  }

  void push_labels() {
    const Table& table = central::table("label");
    TableRows rows = pushing::read_rows(file_, table);
    const std::size_t kind = pushing::place_of(table, "kind"), owner = pushing::place_of(table, "owner");
    std::erase_if(rows.rows,
                  [&](const Row& row) { return row[kind] == "person" && withdrawn_.contains(*row[owner]); });
    const Part part{pushing::digest_of({rows}), "", static_cast<std::int64_t>(rows.rows.size()), 0, 0};
    if (ledger_["labels"]["core"].sha256 == part.sha256) return;
    try {
      pg::Transaction transaction(centre_);
      centre_.script("DELETE FROM vip.label WHERE true" + mine);
      insert(rows);
      note_part("labels", "core", part);
      transaction.commit();
    } catch (const pg::Failure& failure) {
      // Somebody withdrew just now: the next push sends the labels of the others.
      if (failure.sqlstate() != person_withdrew) throw;
    }
  }

  sqlite::Connection& file_;
  pg::Connection centre_;
  std::map<std::string, Parts> ledger_;  // by session, protocol or "labels"
  std::set<std::string> withdrawn_;
  Push done_;
};

}  // namespace

Push push(const StudyFile& study, const std::string& service,
          const std::function<void(std::int64_t done, std::int64_t all)>& told) {
  pg::check_service_name(service);
  const auto file = open_study(study).database;
  return Pusher(*file, service).push(told);
}

std::vector<std::string> withdrawn_at_centre(const StudyFile& study, const std::string& service) {
  pg::check_service_name(service);
  const auto file = open_study(study).database;
  std::map<std::string, std::string> codes;
  std::set<std::string> people;
  for (sqlite::Statement row(*file, "SELECT DISTINCT person, participant FROM session"); row.step();) {
    codes[row.text(0)] = row.text(1);
    people.insert(row.text(0));
  }
  pg::Connection centre(service);
  check_schema_number(centre);
  std::vector<std::string> found;
  for (const std::string& person : withdrawn_among(centre, people)) found.push_back(codes.at(person));
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace study
