#include "libstudy/store/salvage/salvage_rows.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study::salvaging {

using journal::Row;
using journal::Table;
using sqlite::Connection;
using sqlite::Statement;

namespace {

std::size_t index_of(const Shape& shape, const std::string& column) {
  const auto found = std::find_if(shape.columns.begin(), shape.columns.end(),
                                  [&](const Shape::Column& c) { return c.name == column; });
  return static_cast<std::size_t>(found - shape.columns.begin());
}

/// The column of a table that refers to an optional parent: if the parent row is missing, the column becomes
/// NULL and the row stays. nullptr if the table has no such column.
const char* without_which(const std::string& table) {
  if (table == "event") return "presentation_id";
  return table == "presentation" ? "framing_id" : nullptr;
}

std::string text_of(const Shape& shape, const Values& values, const std::string& column) {
  const std::size_t index = index_of(shape, column);
  if (index == values.size()) return {};
  const auto* text = std::get_if<std::string>(&values[index]);
  return text ? *text : std::string();
}

void bind(Statement& statement, int index, const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value))
    statement.bind_at(index, *whole);
  else if (const auto* real = std::get_if<double>(&value))
    statement.bind_at(index, *real);
  else if (const auto* text = std::get_if<std::string>(&value))
    statement.bind_at(index, *text);
  else
    statement.bind_at(index, std::nullopt);
}

/// Sorts rows by their number of NULLs, fewest first. If a row is found twice, one version is older; columns
/// are filled over time, so the version with fewer NULLs is the newer one and is inserted first.
void fuller_first(std::vector<Values>& rows) {
  const auto empty = [](const Values& row) {
    return std::count_if(row.begin(), row.end(), [](const Value& v) { return v.index() == 0; });
  };
  std::stable_sort(rows.begin(), rows.end(),
                   [&](const Values& a, const Values& b) { return empty(a) < empty(b); });
}

/// The column that identifies a row of the table across copies of the database; nullptr if there is none.
const char* identity_of(const Table& table) {
  const std::string name = table.name;
  if (name == "protocol") return "sha256";
  return name == "run" || name == "session" ? "uid" : nullptr;
}

bool is_response(const Table& table) { return table.name == std::string("response"); }

}  // namespace

bool is_large(const std::string& table) {
  constexpr std::array names{"frame",           "slot",   "head",          "gaze",
                             "gaze_validation", "marker", "tracker_clock", "light"};
  return std::find(names.begin(), names.end(), table) != names.end();
}

Rebuild::Rebuild(Connection& target, const JournalContent& journal, Salvage& told)
    : target_(target), journal_(journal), told_(told), shapes_(shapes_of(target)) {
  withdrawn_.insert(journal.forgotten.begin(), journal.forgotten.end());
}

const Shape& Rebuild::shape_of(const std::string& table) const {
  return *std::find_if(shapes_.begin(), shapes_.end(),
                       [&](const Shape& shape) { return shape.table == table; });
}

void Rebuild::take(RowsByTable rows) {
  std::int64_t last = 0;
  for (const Values& row : rows["event"]) last = std::max(last, std::get<std::int64_t>(row[0]));
  journal_is_newer_ = last_event(journal_.kept) >= last;
  // Inserts tombstones first, so that rows of people who withdrew are recognised and omitted.
  std::vector<std::string> order{"tombstone"};
  for (const Table& table : journal::tables()) {
    if (table.name != order.front()) order.emplace_back(table.name);
  }
  order.insert(order.end(), {"export", "export_person", "reserved_slot"});
  for (const std::string& name : order) {
    take_table(shape_of(name), std::move(rows[name]));
    if (const Table* table = journal::find_table(name)) {
      take_journal(*table, journal_.kept, false);
      take_journal(*table, journal_.pending, true);
    }
    if (name == "tombstone") {
      for (Statement row(target_, "SELECT person FROM tombstone"); row.step();)
        withdrawn_.insert(row.text(0));
    }
    if (name == "trial" || name == "unit") complete_plans(name == "unit");
  }
}

Rebuild::Inserted Rebuild::insert(const Shape& shape, const Values& values) {
  auto known = inserts_.find(shape.table);
  if (known == inserts_.end()) {
    std::string places;
    for (std::size_t i = 0; i < shape.columns.size(); ++i) places += places.empty() ? "?" : ", ?";
    known = inserts_
                .emplace(shape.table, Statement(target_, "INSERT OR IGNORE INTO " + shape.table +
                                                             " VALUES (" + places + ") RETURNING 1"))
                .first;
  }
  Statement& statement = known->second;
  for (std::size_t i = 0; i < values.size(); ++i) bind(statement, static_cast<int>(i), values[i]);
  try {
    const bool done = statement.step();
    statement.reset();
    return done ? Inserted::Yes : Inserted::There;
  } catch (const base::Error&) {
    const int code = sqlite3_extended_errcode(target_.handle());
    if ((code & 0xff) != SQLITE_CONSTRAINT) throw;
    return code == SQLITE_CONSTRAINT_FOREIGNKEY ? Inserted::NoParent : Inserted::There;
  }
}

void Rebuild::take_table(const Shape& shape, std::vector<Values> rows) {
  fuller_first(rows);
  for (Values& row : rows) {
    if (shape.table == "session" && withdrew(text_of(shape, row, "person"))) continue;
    Inserted done = insert(shape, row);
    const char* const spared = without_which(shape.table);
    if (done == Inserted::NoParent && spared) {
      row[index_of(shape, spared)] = std::monostate();
      done = insert(shape, row);
    }
    if (done == Inserted::NoParent && withdrawn_.empty()) ++told_.rows_lost[shape.table];
    if (done == Inserted::Yes && shape.table == "response") ++told_.answers_database;
  }
}

void Rebuild::take_journal(const Table& table, const JournalRows& rows, bool under_way) {
  for (auto at = rows.lower_bound({&table, ""}); at != rows.end() && at->first.first == &table; ++at) {
    const Row& row = at->second;
    if (table.name == std::string("session") && withdrew(journal::column(row, "person"))) {
      Statement(target_, "INSERT OR IGNORE INTO tombstone VALUES (?,?,?,?,?)")
          .bind_all(journal::column(row, "person"), journal::column(row, "participant"),
                    journal::column(row, "code"), journal::column(row, "station"), base::utc_now())
          .run();
    } else if (const auto now = journal::stands_as(target_, row)) {
      take_known(row, *now);
    } else if (journal::put(target_, row, journal::Put::Insert)) {
      if (is_response(table)) ++told_.answers_journal;
      if (is_response(table) && under_way) ++told_.answers_under_way;
    } else if (withdrawn_.empty()) {
      ++told_.rows_lost[table.name];
    }
  }
}

void Rebuild::take_known(const Row& row, const Row& now) {
  if (now.line == row.line) return;
  const char* identity = identity_of(*row.table);
  if (identity && journal::column(row, identity) != journal::column(now, identity)) {
    throw base::Error("--db",
                      "names a database whose journal of answers belongs to another study: " +
                          std::string(row.table->name) + " " + row.key + " is " +
                          journal::column(now, identity) + " in the database and " +
                          journal::column(row, identity) + " in the journal",
                      "move the database or its .answers.jsonl file to another folder; vip-study salvage "
                      "rebuilds a study from either of them");
  }
  if (is_response(*row.table))
    told_.different.push_back("in the database " + now.line + ", in the journal " + row.line);
  else if (journal_is_newer_ && row.table->name != std::string("event"))
    journal::put(target_, row, journal::Put::Replace);
}

void Rebuild::take_large(const Shape& shape, const Values& values) {
  const Inserted done = insert(shape, values);
  if (done == Inserted::NoParent && withdrawn_.empty()) ++told_.rows_lost[shape.table];
}

void Rebuild::sum_up() {
  told_.sessions = target_.integer("SELECT count(*) FROM session");
  told_.frames = target_.integer("SELECT count(*) FROM frame");
  told_.frames_lost = target_.integer(
      "SELECT coalesce(sum(max(0, p.frames - (SELECT count(*) FROM frame f WHERE f.presentation_id = "
      "p.presentation_id))), 0) FROM presentation p WHERE p.state = 'played'");
  // A page between two groups of trials has the id of their block but asks none of its questions: excluded
  // here by u.kind.
  Statement lost(target_,
                 "SELECT s.participant, count(*) FROM unit u JOIN session s USING (session_id) "
                 "JOIN ask a ON a.protocol_id = s.protocol_id AND a.block = u.block "
                 "JOIN question q ON q.question_id = a.question_id AND q.personal = 0 "
                 "LEFT JOIN trial t ON t.trial_id = u.trial_id WHERE u.state = 'done' AND t.excluded IS NULL "
                 "AND (u.trial_id IS NOT NULL OR u.kind NOT IN ('practice', 'stimulus', 'repeat', 'catch')) "
                 "AND NOT EXISTS (SELECT 1 FROM response r WHERE r.unit_id = u.unit_id "
                 "AND r.question_id = q.question_id) GROUP BY s.participant");
  while (lost.step()) told_.answers_lost[lost.text(0)] = lost.integer(1);
  for (Statement row(target_, "SELECT participant FROM tombstone ORDER BY 1"); row.step();)
    told_.withdrawn.push_back(row.text(0));
}

namespace {

// If rows of a plan (trials, units) are lost, the plan is computed again: make_plan() is a pure function of
// data that the other tables contain.

struct Planned {
  std::int64_t session = 0, seed = 0;
  std::string participant, code, text, sha256;
  std::optional<double> trial_seconds;
  int slot = 0;
};

std::vector<Planned> sessions_of(Connection& database) {
  std::vector<Planned> all;
  Statement row(
      database,
      "SELECT s.session_id, s.seed, s.participant, s.code, p.text, p.sha256, p.trial_seconds, s.slot "
      "FROM session s JOIN protocol p USING (protocol_id)");
  while (row.step()) {
    Planned one{.session = row.integer(0),
                .seed = row.integer(1),
                .participant = row.text(2),
                .code = row.text(3),
                .text = row.text(4),
                .sha256 = row.text(5),
                .trial_seconds = {},
                .slot = static_cast<int>(row.integer(7))};
    if (!row.is_null(6)) one.trial_seconds = row.real(6);
    all.push_back(std::move(one));
  }
  return all;
}

/// The id of the session's row (trial or unit) with position 0, even if this row is lost: the ids of a
/// session's rows are consecutive. None if no row is left or the ids are not consecutive.
std::optional<std::int64_t> first_row(Connection& database, const std::string& table, std::int64_t session) {
  Statement row(database, "SELECT min(" + table + "_id - position), max(" + table +
                              "_id - position), count(*) FROM " + table + " WHERE session_id = ?");
  if (!row.bind_all(session).step() || row.integer(2) == 0 || row.integer(0) != row.integer(1)) return {};
  return row.integer(0);
}

/// True if all trials of the session that are left are equal to those in the plan.
bool agrees(Connection& database, std::int64_t session, const Plan& plan) {
  Statement row(database,
                "SELECT position, first_cell, second_cell, schedule_seed FROM trial WHERE session_id = ?");
  for (row.bind_all(session); row.step();) {
    const auto position = static_cast<std::size_t>(row.integer(0));
    if (position >= plan.trials.size()) return false;
    const PlannedTrial& trial = plan.trials[position];
    const bool second = trial.second ? !row.is_null(2) && row.integer(2) == *trial.second : row.is_null(2);
    if (row.integer(1) != trial.first || !second ||
        row.integer(3) != static_cast<std::int64_t>(trial.schedule_seed))
      return false;
  }
  return true;
}

std::optional<Plan> plan_of(Connection& database, const Planned& session, const Protocol& protocol) {
  // A merge may have changed the participant's code: try the plan with the new code, then with the original.
  for (const std::string& code : {session.participant, session.code}) {
    Plan plan = make_plan(protocol, code, static_cast<std::uint64_t>(session.seed), session.slot);
    if (agrees(database, session.session, plan)) return plan;
  }
  return {};
}

void add_trials(Connection& database, std::int64_t session, std::int64_t first, const Plan& plan) {
  Statement insert(database,
                   "INSERT OR IGNORE INTO trial (trial_id, session_id, position, group_index, first_cell, "
                   "second_cell, schedule_seed, state, set_aside) VALUES (?,?,?,?,?,?,?,'planned',0)");
  for (const PlannedTrial& trial : plan.trials) {
    insert
        .bind_all(first + trial.position, session, trial.position, trial.group, trial.first, trial.second,
                  static_cast<std::int64_t>(trial.schedule_seed))
        .run();
  }
}

void add_units(Connection& database, std::int64_t session, std::int64_t first,
               std::optional<std::int64_t> first_trial, const Protocol& protocol, const Plan& plan) {
  Statement insert(database,
                   "INSERT OR IGNORE INTO unit (unit_id, session_id, position, block, block_index, kind, "
                   "trial_id, state) VALUES (?,?,?,?,?,?,?,'planned')");
  for (const PlannedUnit& unit : plan.units) {
    const Block& block = protocol.blocks.at(static_cast<std::size_t>(unit.block));
    std::optional<std::int64_t> trial;
    if (unit.trial && !first_trial) continue;
    if (unit.trial) trial = *first_trial + *unit.trial;
    insert
        .bind_all(first + unit.position, session, unit.position, block.id, unit.block,
                  block_kind_name(block.kind), trial)
        .run();
  }
}

}  // namespace

// Inserts the lost trials, or the lost units if `units` is true. If no such row of a session is left, inserts
// none for the session: the row numbers, to which answers refer, are then unknown.
void Rebuild::complete_plans(bool units) {
  for (const Planned& session : sessions_of(target_)) {
    const auto first = first_row(target_, units ? "unit" : "trial", session.session);
    if (!first) continue;
    try {
      Protocol protocol =
          parse_protocol(session.text, "protocol of session " + std::to_string(session.session));
      if (session.trial_seconds) override_trial_seconds(protocol, *session.trial_seconds);
      if (protocol.sha256 != session.sha256) continue;
      const auto plan = plan_of(target_, session, protocol);
      if (plan && units)
        add_units(target_, session.session, *first, first_row(target_, "trial", session.session), protocol,
                  *plan);
      else if (plan)
        add_trials(target_, session.session, *first, *plan);
    } catch (const base::Error&) {
      // The protocol may have an old format that this program cannot read: the lost rows then stay lost.
    }
  }
}

}  // namespace study::salvaging
