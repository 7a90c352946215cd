/// Copies rows from the sources of a merge into the merged database, with new row numbers.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/file/schema.hpp"
#include "libstudy/store/merge/merge_parts.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/refusals.hpp"
#include "stats/base/error.hpp"

namespace study::merging {

using sqlite::Connection;
using sqlite::Statement;

namespace {

// Copies of a permission change are recognised by the columns that never change (Key). The other columns
// (Known) only increase: each takes the largest value of all copies. So the result depends neither on the
// order nor on the number of merges.

/// Identifies a permission change by four columns: what ("gaze" or "sharing"), utc, whether it is a refusal,
/// and uid.
using Key = std::tuple<std::string, std::string, bool, std::optional<std::string>>;

struct Known {
  std::optional<std::int64_t> turn, answers, showings, superseded;
};

std::optional<std::int64_t> number(const Statement& row, int column) {
  if (row.is_null(column)) return {};
  return row.integer(column);
}

void read_changes(Connection& source, std::int64_t session, std::map<Key, Known>& changes) {
  Statement row(source,
                "SELECT what, utc, granted, uid, turn, answers, showings, superseded FROM permission_change "
                "WHERE session_id = ?");
  for (row.bind_all(session); row.step();) {
    std::optional<std::string> uid;
    if (!row.is_null(3)) uid = row.text(3);
    Known& known = changes[{row.text(0), row.text(1), row.integer(2) == 0, uid}];
    known.turn = std::max(known.turn, number(row, 4));
    known.answers = std::max(known.answers, number(row, 5));
    known.showings = std::max(known.showings, number(row, 6));
    known.superseded = std::max(known.superseded, number(row, 7));
  }
}

/// The changes in the order of their column `turn`, which is the row order of each source. Changes from
/// different sources with equal `turn` are ordered by their Key.
std::vector<std::pair<Key, Known>> in_order(const std::map<Key, Known>& changes) {
  std::vector<std::pair<Key, Known>> rows(changes.begin(), changes.end());
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.second.turn < b.second.turn; });
  return rows;
}

/// Adds the permission changes of all copies of a session, without duplicates, to session `session` of the
/// target. A change that is superseded in one copy is superseded in the target, whatever the times (utc) of
/// the changes are.
void add_permissions(Content& content, const std::string& uid, Connection& target, std::int64_t session) {
  std::map<Key, Known> changes;
  std::set<std::pair<std::string, std::string>> events;  // utc and detail of each permission event
  for (const SessionCopy& copy : content.copies) {
    if (copy.uid != uid) continue;
    Connection& source = *content.sources[copy.source];
    read_changes(source, copy.id, changes);
    Statement event(source, "SELECT utc, detail FROM event WHERE session_id = ? AND kind = ?");
    for (event.bind_all(copy.id, permission_event); event.step();)
      events.emplace(event.text(0), event.text(1));
  }
  Statement change(target,
                   "INSERT INTO permission_change (session_id, what, utc, granted, uid, turn, answers, "
                   "showings, superseded) VALUES (?,?,?,?,?,?,?,?,?)");
  for (const auto& [key, known] : in_order(changes)) {
    const auto& [what, utc, refused, identity] = key;
    change
        .bind_all(session, what, utc, refused ? 0 : 1, identity, known.turn, known.answers, known.showings,
                  known.superseded)
        .run();
  }
  Statement event(target, "INSERT INTO event (session_id, utc, kind, detail) VALUES (?,?,?,?)");
  for (const auto& [utc, detail] : events) event.bind_all(session, utc, permission_event, detail).run();
}

/// Sorts labels by kind, by the time at which the person was first planned, then by owner and label. So the
/// order does not depend on the order of the sources.
void sort_labels(std::vector<GivenLabel>& labels, const Content& content) {
  std::map<std::string, std::string> planned;
  for (const SessionCopy& copy : content.copies) {
    const auto [known, fresh] = planned.try_emplace(copy.person, copy.planned_utc);
    if (!fresh) known->second = std::min(known->second, copy.planned_utc);
  }
  const auto key = [&](const GivenLabel& one) {
    const auto when = planned.find(one.owner);
    return std::tuple(one.kind, when == planned.end() ? std::string() : when->second, one.owner, one.label);
  };
  std::sort(labels.begin(), labels.end(),
            [&](const GivenLabel& a, const GivenLabel& b) { return key(a) < key(b); });
}

/// Stores the labels of the merged database (export_labels.hpp). The labels of the source at the target's
/// path stay unchanged. The other sources' labels are added in the order of sort_labels(). Labels of people
/// who withdrew are omitted.
void add_labels(const Content& content, sqlite::Connection& target) {
  const auto into = std::filesystem::weakly_canonical(target.path());
  std::vector<GivenLabel> first, others;
  for (const auto& source : content.sources) {
    const bool stays = std::filesystem::weakly_canonical(source->path()) == into;
    const std::vector<GivenLabel> found = labels_of(*source);
    std::vector<GivenLabel>& list = stays ? first : others;
    list.insert(list.end(), found.begin(), found.end());
  }
  sort_labels(others, content);
  std::vector<GivenLabel> joined = joined_labels(first, others);
  std::erase_if(joined, [&](const GivenLabel& one) {
    return one.kind == "person" && content.tombstones.contains(one.owner);
  });
  store_labels(target, joined);
}

/// For each column with row numbers ("trial_id", ...): the new row number of each old row number.
using RowNumbers = std::map<std::string, std::unordered_map<std::int64_t, std::int64_t>>;

/// A table whose rows belong to a session.
struct Table {
  const char* name;
  const char* key;   // column with the row number to which other tables refer; empty: none
  const char* rows;  // SQL condition that selects the rows of a session; ?1: session_id
};

constexpr const char* of_session = "session_id = ?1";
constexpr const char* of_presentation =
    "presentation_id IN (SELECT presentation_id FROM presentation JOIN trial USING (trial_id) "
    "WHERE session_id = ?1)";
const Table session_tables[] = {
    {"session", "session_id", of_session},
    {"framing", "framing_id", of_session},
    {"headset", "headset_id", of_session},
    {"ipd", "ipd_id", of_session},
    {"trial", "trial_id", of_session},
    {"unit", "unit_id", of_session},
    {"presentation", "presentation_id", "trial_id IN (SELECT trial_id FROM trial WHERE session_id = ?1)"},
    {"frame", "", of_presentation},
    {"slot", "", of_presentation},
    {"head", "", of_presentation},
    {"gaze", "", of_presentation},
    {"gaze_validation", "", of_session},
    {"marker", "marker_id", of_session},
    {"tracker_clock", "tracker_clock_id", of_session},
    {"light", "", of_presentation},
    {"response", "response_id", "unit_id IN (SELECT unit_id FROM unit WHERE session_id = ?1)"},
    {"note", "note_id", of_session},
    {"event", "event_id", "session_id = ?1 AND kind <> 'permission changed'"},
};

/// Throws the error for a row that refers to a row of another session; SQLite's foreign keys permit such
/// rows.
[[noreturn]] void throw_stray(const Connection& source, const Statement& row, const std::string& table,
                              const std::string& key, int column) {
  throw base::Error(source.path().string(),
                    (key.empty() ? "a row of " : "row " + row.text(0) + " of ") + table + " points to " +
                        row.column_name(column) + " " + row.text(column) + ", which is not of its session",
                    "make a sound copy with vip-study salvage, or leave this database out");
}

/// Copies the rows of one table that belong to `parent` (?1 in table.rows), with new row numbers. changed: by
/// column name, values that replace the row's values.
void copy_rows(Connection& source, Connection& target, const Table& table, std::int64_t parent,
               RowNumbers& numbers, const std::map<std::string, std::string>& changed = {}) {
  const std::string name = table.name, key = table.key, columns = listed(columns_of(name));
  Statement row(source, "SELECT " + columns + " FROM " + name + " WHERE " + table.rows + " ORDER BY " +
                            (key.empty() ? "1, 2" : key));
  row.bind_all(parent);
  std::string values;
  for (int i = 0; i < row.columns(); ++i) values += i ? ", ?" : "?";
  Statement insert(target, "INSERT INTO " + name + " (" + columns + ") VALUES (" + values + ")");
  std::vector<const std::unordered_map<std::int64_t, std::int64_t>*> mapped;
  std::vector<const std::string*> fixed;
  for (int i = 0; i < row.columns(); ++i) {
    const auto map = numbers.find(row.column_name(i));
    const auto value = changed.find(row.column_name(i));
    mapped.push_back(map == numbers.end() || row.column_name(i) == key ? nullptr : &map->second);
    fixed.push_back(value == changed.end() ? nullptr : &value->second);
  }
  while (row.step()) {
    std::int64_t old = 0;
    for (int i = 0; i < row.columns(); ++i) {
      const auto column = static_cast<std::size_t>(i);
      if (i == 0 && !key.empty()) {
        old = row.integer(0);
        insert.bind_at(i, std::nullopt);
      } else if (fixed[column]) {
        insert.bind_at(i, *fixed[column]);
      } else if (mapped[column] && !row.is_null(i)) {
        const auto number = mapped[column]->find(row.integer(i));
        if (number == mapped[column]->end()) throw_stray(source, row, name, key, i);
        insert.bind_at(i, number->second);
      } else {
        insert.bind_from(i, row, i);
      }
    }
    const std::int64_t added = insert.run();
    if (!key.empty()) numbers[key][old] = added;
  }
}

class Union {
 public:
  Union(Content& content, const std::map<std::string, std::string>& names, Connection& target)
      : content_(content), names_(names), target_(target), numbers_(content.sources.size()) {}

  void add_protocols() {
    for (const std::string& sha256 : all_protocols()) {
      for (std::size_t i = 0; i < content_.sources.size(); ++i) add_protocol(i, sha256);
    }
  }

  void add_tombstones() {
    Statement insert(target_, "INSERT INTO tombstone VALUES (?,?,?,?,?)");
    for (const auto& [person, stone] : content_.tombstones) {
      insert.bind_all(person, names_.at(person), stone.code, stone.station, stone.withdrawn_utc).run();
    }
  }

  /// Adds the events that belong to no session, such as exports, without duplicates.
  void add_common_events() {
    using Event = std::tuple<std::string, std::optional<std::int64_t>, std::string, std::string>;
    std::set<Event> events;
    for (const auto& source : content_.sources) {
      Statement row(*source, "SELECT utc, clock_ns, kind, detail FROM event WHERE session_id IS NULL");
      while (row.step()) {
        std::optional<std::int64_t> clock_ns;
        if (!row.is_null(1)) clock_ns = row.integer(1);
        events.emplace(row.text(0), clock_ns, row.text(2), row.text(3));
      }
    }
    Statement insert(target_, "INSERT INTO event (utc, clock_ns, kind, detail) VALUES (?,?,?,?)");
    for (const auto& [utc, clock_ns, kind, detail] : events)
      insert.bind_all(utc, clock_ns, kind, detail).run();
  }

  void add_session(const SessionCopy& copy) {
    Connection& source = *content_.sources[copy.source];
    RowNumbers numbers = numbers_[copy.source];
    add_run(source, copy, numbers);
    for (const Table& table : session_tables)
      copy_rows(source, target_, table, copy.id, numbers, changes_to(table, copy));
    add_permissions(content_, copy.uid, target_, numbers.at("session_id").at(copy.id));
  }

 private:
  std::map<std::string, std::string> changes_to(const Table& table, const SessionCopy& copy) const {
    if (std::string(table.name) != "session") return {};
    return {{"participant", names_.at(copy.person)}};
  }

  std::vector<std::string> all_protocols() {
    std::set<std::tuple<std::string, std::string, std::string>> found;
    for (const auto& source : content_.sources) {
      Statement row(*source, "SELECT name, version, sha256 FROM protocol");
      while (row.step()) found.emplace(row.text(0), row.text(1), row.text(2));
    }
    std::vector<std::string> out;
    for (const auto& [name, version, sha256] : found) out.push_back(sha256);
    return out;
  }

  /// Adds the protocol with this hash from source number `index` to the target. Copies the protocol's row and
  /// its rows of `ask` and `cell` unless the target has them. Copies the questions that the target lacks.
  void add_protocol(std::size_t index, const std::string& sha256) {
    Connection& source = *content_.sources[index];
    RowNumbers& numbers = numbers_[index];
    Statement here(source, "SELECT protocol_id FROM protocol WHERE sha256 = ?");
    if (!here.bind_all(sha256).step()) return;
    const std::int64_t id = here.integer(0);
    here.reset();
    Statement there(target_, "SELECT protocol_id FROM protocol WHERE sha256 = ?");
    if (there.bind_all(sha256).step()) {
      numbers["protocol_id"][id] = there.integer(0);
    } else {
      copy_rows(source, target_, {"protocol", "protocol_id", "protocol_id = ?1"}, id, numbers);
    }
    add_questions(source, id, numbers);
    add_dependants(source, id, numbers, "ask");
    add_dependants(source, id, numbers, "cell");
  }

  void add_questions(Connection& source, std::int64_t protocol, RowNumbers& numbers) {
    Statement row(source,
                  "SELECT question_id, code FROM question WHERE protocol_id = ? ORDER BY question_id");
    row.bind_all(protocol);
    Statement there(target_, "SELECT question_id FROM question WHERE protocol_id = ? AND code = ?");
    while (row.step()) {
      const std::int64_t old = row.integer(0);
      there.bind_all(numbers["protocol_id"].at(protocol), row.text(1));
      if (there.step()) {
        numbers["question_id"][old] = there.integer(0);
        there.reset();
      } else {
        copy_rows(source, target_, {"question", "question_id", "question_id = ?1"}, old, numbers);
      }
    }
  }

  /// Adds a protocol's rows of `ask` or `cell` unless the target has some. These rows are equal in all
  /// sources that have the protocol, so one source is enough.
  void add_dependants(Connection& source, std::int64_t protocol, RowNumbers& numbers, const char* table) {
    Statement there(target_, std::string("SELECT 1 FROM ") + table + " WHERE protocol_id = ?");
    if (there.bind_all(numbers["protocol_id"].at(protocol)).step()) return;
    copy_rows(source, target_, {table, "", "protocol_id = ?1"}, protocol, numbers);
  }

  void add_run(Connection& source, const SessionCopy& copy, RowNumbers& numbers) {
    Statement here(source, "SELECT run_id FROM session WHERE session_id = ?");
    here.bind_all(copy.id).step();
    const std::int64_t id = here.integer(0);
    Statement there(target_, "SELECT run_id FROM run WHERE uid = ?");
    if (there.bind_all(copy.run_uid).step()) {
      numbers["run_id"][id] = there.integer(0);
    } else {
      copy_rows(source, target_, {"run", "run_id", "run_id = ?1"}, id, numbers);
    }
  }

  Content& content_;
  const std::map<std::string, std::string>& names_;
  Connection& target_;
  std::vector<RowNumbers> numbers_;  // new row numbers of protocols and questions, by source
};

}  // namespace

void write_union(Content& content, const std::vector<SessionCopy>& chosen,
                 const std::map<std::string, std::string>& names, Connection& target) {
  sqlite::Transaction transaction(target);
  Union all(content, names, target);
  all.add_protocols();
  all.add_tombstones();
  all.add_common_events();
  for (const SessionCopy& copy : chosen) all.add_session(copy);
  drop_unallowed_gaze(target);
  add_labels(content, target);
  for (const auto& source : content.sources) add_exports(*source, target);
  transaction.commit();
}

void add_exports(Connection& source, Connection& target) {
  Statement row(source,
                "SELECT kind, path, host, sha256, utc, tackled, export_id FROM export ORDER BY host, path");
  Statement add(target,
                "INSERT INTO export (kind, path, host, sha256, utc, tackled) VALUES (?,?,?,?,?,?) "
                "ON CONFLICT (host, path) DO UPDATE SET kind = excluded.kind, sha256 = excluded.sha256, "
                "utc = excluded.utc, tackled = excluded.tackled "
                "WHERE (excluded.utc, excluded.sha256) > (export.utc, export.sha256)");
  Statement person(source, "SELECT person FROM export_person WHERE export_id = ?");
  Statement add_person(target,
                       "INSERT OR IGNORE INTO export_person "
                       "SELECT export_id, ?3 FROM export WHERE host = ?1 AND path = ?2");
  while (row.step()) {
    for (int i = 0; i < 6; ++i) add.bind_from(i, row, i);
    add.run();
    for (person.bind_all(row.integer(6)); person.step();)
      add_person.bind_all(row.text(2), row.text(1), person.text(0)).run();
  }
}

}  // namespace study::merging
