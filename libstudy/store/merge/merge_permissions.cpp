/// Permission changes in a merge. A change is identified by its constant fields. Fields that only grow
/// (superseded, and how much of the session it knew) take the largest value of all copies, so that neither
/// the order nor the number of merges matters.
#include <algorithm>
#include <optional>
#include <set>
#include <tuple>

#include "libstudy/store/merge/merge_parts.hpp"
#include "libstudy/store/permissions.hpp"

namespace study::merging {

using sqlite::Connection;
using sqlite::Statement;

namespace {

/// What, when, refused or not, identity.
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

/// Keeps the row order of each source. Changes from sources that did not know of each other are ordered by
/// their content alone.
std::vector<std::pair<Key, Known>> in_order(const std::map<Key, Known>& changes) {
  std::vector<std::pair<Key, Known>> rows(changes.begin(), changes.end());
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.second.turn < b.second.turn; });
  return rows;
}

}  // namespace

void add_permissions(Content& content, const std::string& uid, Connection& target, std::int64_t session) {
  std::map<Key, Known> changes;
  std::set<std::pair<std::string, std::string>> events;  // when, detail
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

}  // namespace study::merging
