#include "libstudy/store/push/push.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/push/centre.hpp"
#include "libstudy/store/push/session_copy.hpp"
#include "stats/base/error.hpp"

namespace study {

using central::Table;
using pg::Row;
using pushing::and_mine;
using pushing::at_centre;
using pushing::Centre;
using pushing::Core;
using pushing::LocalSession;
using pushing::Part;
using pushing::Parts;
using pushing::TableRows;

namespace {

constexpr const char* person_withdrew = "VP001";  // sql/central.sql
// Rows of large tables that one transaction sends at most, apart from those of its last presentation.
constexpr std::size_t rows_at_once = 20000;

/// A session that the centre does not take.
class Diverged : public base::Error {
  using Error::Error;
};

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

std::string of_session(const std::string& uid) {
  return " WHERE session_uid = " + pg::quoted_text(uid) + and_mine;
}

/// An event_id after all events of a session.
std::int64_t next_event(const Core& core) {
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
  Parts parts;
  std::string deletions;
  std::size_t count = 0;
};

class Pusher {
 public:
  Pusher(sqlite::Connection& file, const std::string& service) : file_(file), centre_(service) {
    centre_.take_turn();
  }

  Push push(const std::function<void(std::int64_t, std::int64_t)>& told) {
    push_tombstones();
    const auto sessions = pushing::read_sessions(file_);
    std::set<std::string> people;
    for (const LocalSession& session : sessions) people.insert(session.person);
    withdrawn_ = centre_.withdrawn_among(people);
    ledger_ = centre_.read_ledger();
    done_.sessions = static_cast<std::int64_t>(sessions.size());
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      if (told) told(static_cast<std::int64_t>(i), done_.sessions);
      try_session(sessions[i]);
    }
    push_labels();
    done_.bytes = centre_.connection().bytes_sent();
    return done_;
  }

 private:
  void push_tombstones() {
    const Table& table = central::table("tombstone");
    const auto known = centre_.connection().run("SELECT person FROM vip.tombstone WHERE true" + and_mine);
    std::set<std::string> there;
    for (int i = 0; i < known.size(); ++i) there.insert(known.text(i, 0));
    const std::size_t person = pushing::place_of(table, "person");
    for (const Row& row : pushing::read_rows(file_, table).rows) {
      // One at a time: each waits for the transactions about its person.
      if (!there.contains(*row[person]))
        done_.tombstones += centre_.insert({&table, {row}}, "ON CONFLICT DO NOTHING");
    }
  }

  void insert(const TableRows& rows, const std::string& tail = "") {
    done_.rows += centre_.insert(rows, tail);
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
      if (failure.sqlstate() == person_withdrew || withdrew_now(session.person))
        ++done_.withdrawn;
      else
        done_.refused.push_back(name + ": " + failure.what());
    } catch (const Diverged& error) {
      done_.refused.push_back(name + ": " + error.what());
    }
  }

  /// True if the person withdrew since the push began, so that rows lost their parents at the centre.
  bool withdrew_now(const std::string& person) {
    if (!centre_.withdrawn_among({person}).contains(person)) return false;
    withdrawn_.insert(person);
    return true;
  }

  void push_session(const LocalSession& session) {
    const Reading reading(file_);
    const Core core = pushing::read_core(file_, session);
    const Parts& parts = ledger_[session.uid];
    const auto part = parts.find("core");
    const bool there = part != parts.end(), same = there && part->second.sha256 == core.sha256;
    if (there && !same && is_older(session, core, part->second)) {
      join_older(session, core);
      ++done_.older;
      return;
    }
    if (!same) {
      push_protocol(session);
      replace_core(session, core, there);
    }
    const bool large = push_large(session, core, same);
    if (large || !same) ++done_.sent;
  }

  /// True if the centre has a later state of the session. Diverged if neither began with the other.
  bool is_older(const LocalSession& session, const Core& core, const Part& there) {
    const auto here = static_cast<std::int64_t>(core.log.size());
    const auto log = here < there.events ? centre_.log(session.uid, here) : std::vector<Row>();
    const std::string before = here < there.events ? pushing::log_digest(log, log.size()) : there.log_sha256;
    const auto both = static_cast<std::size_t>(std::min(here, there.events));
    if (pushing::log_digest(core.log, both) != before) {
      throw Diverged(file_.path().string(),
                     "the session continued differently in the copy that was pushed before",
                     "decide which of the two counts: push that file alone, or let the owner of the central "
                     "database delete the session there");
    }
    return here < there.events || (here == there.events && core.progress < there.progress);
  }

  /// Joins the permissions of an older copy into those at the centre.
  void join_older(const LocalSession& session, const Core& core) {
    pg::Connection& centre = centre_.connection();
    pg::Transaction transaction(centre);
    TableRows changes = centre_.changes(session.uid), events = centre_.change_events(session.uid);
    const std::int64_t last =
        centre.run("SELECT coalesce(max(event_id), 0) FROM vip.event" + of_session(session.uid))
            .integer(0, 0);
    const bool changed = pushing::join_changes(changes, core.changes);
    const bool told = pushing::join_change_events(events, core.change_events, last + 1);
    if (!changed && !told) return;
    centre.run("DELETE FROM vip.permission_change" + of_session(session.uid));
    centre.run("DELETE FROM vip.event" + of_session(session.uid) + " AND kind = $1", {permission_event});
    insert(changes);
    insert(events);
    drop_refused_gaze(session);
    transaction.commit();
  }

  void drop_refused_gaze(const LocalSession& session) {
    centre_.connection().run("SELECT vip.drop_refused_gaze($1)", {session.uid});
  }

  void push_protocol(const LocalSession& session) {
    std::vector<TableRows> tables;
    for (const Table* table : central::in_order()) {
      if (table->scope == central::Scope::Protocol)
        tables.push_back(pushing::read_rows(file_, *table, session.protocol_id));
    }
    Part part{pushing::digest_of(tables)};
    Part& known = ledger_[session.protocol_sha256]["core"];
    if (known.sha256 == part.sha256) return;
    pg::Transaction transaction(centre_.connection());
    for (const TableRows& rows : tables) {
      insert(rows, "ON CONFLICT DO NOTHING");
      part.rows += static_cast<std::int64_t>(rows.rows.size());
    }
    centre_.note(session.protocol_sha256, {{"core", part}});
    transaction.commit();
    known = part;
  }

  /// Replaces the small tables of a session. there: the centre has some.
  void replace_core(const LocalSession& session, const Core& core, bool there) {
    TableRows changes = core.changes, events = core.change_events;
    pg::Transaction transaction(centre_.connection());
    if (there) {
      pushing::join_changes(changes, centre_.changes(session.uid));
      pushing::join_change_events(events, centre_.change_events(session.uid), next_event(core));
      std::string sql;
      for (const Table& table : central::tables()) {
        if (table.scope == central::Scope::Session && !table.large)
          sql += "DELETE FROM " + at_centre(table) + of_session(session.uid) + ";";
      }
      centre_.connection().script(sql);
    }
    insert(pushing::read_rows(file_, central::table("run"), session.run_id), "ON CONFLICT DO NOTHING");
    Part part{core.sha256, 0, static_cast<std::int64_t>(core.log.size()), core.progress,
              pushing::log_digest(core.log, core.log.size())};
    for (const TableRows& rows : core.tables) {
      insert(rows);
      part.rows += static_cast<std::int64_t>(rows.rows.size());
    }
    insert(changes);
    insert(events);
    centre_.note(session.uid, {{"core", part}});
    if (!changes.rows.empty()) drop_refused_gaze(session);
    transaction.commit();
  }

  /// Sends the large tables of a session, a part for each presentation. counted: the rest of the session did
  /// not change, so that equal numbers of rows are equal rows. True if something was sent.
  bool push_large(const LocalSession& session, const Core& core, bool counted) {
    bool sent = false;
    Waiting waiting;
    for (const pushing::Showing& showing : core.showings) {
      for (const Table& table : central::tables())
        if (table.large) add_part(session, table, showing, counted, waiting);
      if (waiting.count > rows_at_once) sent = send_parts(session, waiting) || sent;
    }
    return send_parts(session, waiting) || sent;
  }

  void add_part(const LocalSession& session, const Table& table, const pushing::Showing& showing,
                bool counted, Waiting& waiting) {
    const std::int64_t count = pushing::count_large(file_, table, showing);
    const std::string name = table.name + " " + std::to_string(showing.number);
    const Parts& parts = ledger_[session.uid];
    const auto known = parts.find(name);
    // Fewer rows: an older copy, or gaze that is refused, which the centre deletes by itself.
    if (count == 0 || (known != parts.end() && count < known->second.rows + (counted ? 1 : 0))) return;
    TableRows rows = pushing::read_large(file_, table, session, showing);
    const std::string sha256 = pushing::digest_of({rows});
    if (known != parts.end()) {
      if (known->second.sha256 == sha256) return;
      waiting.deletions += "DELETE FROM " + at_centre(table) + of_session(session.uid) +
                           " AND presentation_id = " + std::to_string(showing.number) + ";";
    }
    waiting.parts[name] = {sha256, count};
    waiting.count += rows.rows.size();
    TableRows& all = waiting.rows[&table];
    all.table = &table;
    std::move(rows.rows.begin(), rows.rows.end(), std::back_inserter(all.rows));
  }

  /// Sends the parts that wait, in one transaction. False if there are none.
  bool send_parts(const LocalSession& session, Waiting& waiting) {
    if (waiting.parts.empty()) return false;
    pg::Transaction transaction(centre_.connection());
    if (!waiting.deletions.empty()) centre_.connection().script(waiting.deletions);
    bool motion = false;
    for (const auto& [table, rows] : waiting.rows) {
      insert(rows);
      motion = motion || table->name == "gaze" || table->name == "head";
    }
    centre_.note(session.uid, waiting.parts);
    if (motion) drop_refused_gaze(session);
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
    const Part part{pushing::digest_of({rows}), static_cast<std::int64_t>(rows.rows.size())};
    if (ledger_["labels"]["core"].sha256 == part.sha256) return;
    try {
      pg::Transaction transaction(centre_.connection());
      centre_.connection().script("DELETE FROM vip.label WHERE true" + and_mine);
      insert(rows);
      centre_.note("labels", {{"core", part}});
      transaction.commit();
    } catch (const pg::Failure& failure) {
      // Somebody withdrew just now: the next push sends the labels of the others.
      if (failure.sqlstate() != person_withdrew) throw;
    }
  }

  sqlite::Connection& file_;
  Centre centre_;
  pushing::Ledger ledger_;
  std::set<std::string> withdrawn_;
  Push done_;
};

}  // namespace

Push push(const StudyFile& study, const std::string& service,
          const std::function<void(std::int64_t done, std::int64_t all)>& told) {
  pg::check_service_name(service);
  refuse_service(study.path);
  const auto file = open_study(study).database;
  return Pusher(*file, service).push(told);
}

std::vector<std::string> withdrawn_at_centre(const StudyFile& study, const std::string& service) {
  pg::check_service_name(service);
  refuse_service(study.path);
  const auto file = open_study(study).database;
  std::map<std::string, std::string> codes;
  std::set<std::string> people;
  for (sqlite::Statement row(*file, "SELECT DISTINCT person, participant FROM session"); row.step();) {
    codes[row.text(0)] = row.text(1);
    people.insert(row.text(0));
  }
  Centre centre(service);
  std::vector<std::string> found;
  for (const std::string& person : centre.withdrawn_among(people)) found.push_back(codes.at(person));
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace study
