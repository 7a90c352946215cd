/// Reads the sources of a merge: chooses the copy of each session that counts, gives people distinct codes,
/// and checks that the stations assigned disjoint shares of the slots (positions in the counterbalancing).
#include <algorithm>
#include <set>
#include <tuple>

#include "libstudy/store/merge/merge_parts.hpp"
#include "libstudy/store/permissions.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study::merging {

using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr const char* merged_sessions_sql =
    "SELECT s.session_id, s.uid, s.person, s.code, s.station, r.uid, r.started_utc, p.sha256, s.visit, "
    "s.test_data, (SELECT count(*) FROM event e WHERE e.session_id = s.session_id AND e.kind <> ?1), "
    "(SELECT count(*) FROM frame JOIN presentation USING (presentation_id) JOIN trial t USING (trial_id) "
    "WHERE t.session_id = s.session_id), "
    "(SELECT count(*) FROM presentation q JOIN trial t USING (trial_id) WHERE t.session_id = s.session_id "
    "AND q.state = 'played'), s.station_number, s.station_count, "
    "s.test_data = p.test_data AND s.state IN ('open', 'done', 'stopped'), "
    "(SELECT count(*) FROM gaze JOIN presentation USING (presentation_id) JOIN trial t USING (trial_id) "
    "WHERE t.session_id = s.session_id) + "
    "(SELECT count(*) FROM head JOIN presentation USING (presentation_id) JOIN trial t USING (trial_id) "
    "WHERE t.session_id = s.session_id) + "
    "(SELECT count(*) FROM gaze_validation v WHERE v.session_id = s.session_id), "
    "s.reservation IS NOT NULL "
    "FROM session s JOIN run r USING (run_id) JOIN protocol p USING (protocol_id) ORDER BY s.session_id";

/// The events of a session as text, without permission changes: permissions may change in any copy of the
/// session, and add_permissions() joins the changes.
std::vector<std::string> log_of(Connection& source, std::int64_t session) {
  Statement row(source,
                "SELECT utc || ' ' || coalesce(clock_ns, '') || ' ' || kind || ' ' || detail FROM event "
                "WHERE session_id = ? AND kind <> ? ORDER BY event_id");
  row.bind_all(session, permission_event);
  std::vector<std::string> log;
  while (row.step()) log.push_back(row.text(0));
  return log;
}

/// True if copy `a` has less progress than copy `b`. With equal progress, the copy with more gaze wins: gaze
/// that is refused is deleted from the merged database later (drop_unallowed_gaze()).
bool less_far(const SessionCopy& a, const SessionCopy& b) {
  return std::tie(a.events, a.frames, a.played, a.gaze) < std::tie(b.events, b.frames, b.played, b.gaze);
}

/// base::Error unless the events of `earlier` are the first events of `later`; otherwise the copies diverged.
void check_earlier(Content& content, const SessionCopy& earlier, const SessionCopy& later) {
  const auto before = log_of(*content.sources[earlier.source], earlier.id);
  const auto after = log_of(*content.sources[later.source], later.id);
  if (before.size() <= after.size() && std::equal(before.begin(), before.end(), after.begin())) return;
  throw base::Error(content.sources[later.source]->path().string(),
                    "participant " + later.code + ", visit " + std::to_string(later.visit) +
                        ", continued differently in a copy, " +
                        content.sources[earlier.source]->path().string(),
                    "decide which of the two counts, and leave the other database out");
}

void check_visits(Content& content, const std::vector<SessionCopy>& chosen) {
  std::map<std::tuple<std::string, std::string, int>, const SessionCopy*> visits;
  for (const SessionCopy& copy : chosen) {
    const auto [other, fresh] = visits.try_emplace({copy.person, copy.protocol_sha256, copy.visit}, &copy);
    if (fresh) continue;
    throw base::Error(content.sources[copy.source]->path().string(),
                      "participant " + copy.code + " has visit " + std::to_string(copy.visit) +
                          " of the same protocol a second time in " +
                          content.sources[other->second->source]->path().string(),
                      "decide which of the two counts, and leave the other database out");
  }
}

/// Describes a row whose parent is missing, in a table without row numbers, by the column that refers to the
/// parent.
std::string dangling_row(Connection& source, const std::string& table, const std::string& parent,
                         std::int64_t foreign_key) {
  Statement link(source, "SELECT \"from\" FROM pragma_foreign_key_list(?) WHERE id = ?");
  if (!link.bind_all(table, foreign_key).step()) return "a row of " + table;
  const std::string column = link.text(0);
  Statement lost(source, "SELECT " + column + " FROM " + table + " WHERE " + column + " NOT IN (SELECT " +
                             column + " FROM " + parent + ") LIMIT 1");
  return "a row of " + table + " with " + column + " " + (lost.step() ? lost.text(0) : "");
}

/// base::Error if a row's parent is missing: the merge would lose such a row, or fail.
void check_references(Connection& source) {
  Statement lost(source, "PRAGMA foreign_key_check");
  if (!lost.step()) return;
  const std::string table = lost.text(0), parent = lost.text(2);
  const std::string row = lost.is_null(1) ? dangling_row(source, table, parent, lost.integer(3))
                                          : "row " + lost.text(1) + " of " + table;
  throw base::Error(source.path().string(), row + " refers to a missing row of " + parent,
                    "make a sound copy with vip-study salvage, or leave this database out");
}

}  // namespace

void add_source(Content& content, std::unique_ptr<Connection> source) {
  check_references(*source);
  const std::size_t index = content.sources.size();
  Statement row(*source, merged_sessions_sql);
  for (row.bind_all(permission_event); row.step();) {
    SessionCopy copy;
    copy.source = index;
    copy.id = row.integer(0);
    copy.uid = row.text(1);
    copy.person = row.text(2);
    copy.code = row.text(3);
    copy.station = row.text(4);
    copy.run_uid = row.text(5);
    copy.planned_utc = row.text(6);
    copy.protocol_sha256 = row.text(7);
    copy.visit = static_cast<int>(row.integer(8));
    copy.test_data = row.integer(9) != 0;
    copy.events = row.integer(10);
    copy.frames = row.integer(11);
    copy.played = row.integer(12);
    if (!row.is_null(13))
      copy.station_number =
          StationNumber{static_cast<int>(row.integer(13)), static_cast<int>(row.integer(14))};
    copy.counts = row.integer(15) != 0;
    copy.gaze = row.integer(16);
    copy.reserved = row.integer(17) != 0;
    content.copies.push_back(std::move(copy));
  }
  Statement stone(*source, "SELECT person, code, station, withdrawn_utc FROM tombstone");
  while (stone.step()) {
    const Tombstone found{stone.text(0), stone.text(1), stone.text(2), stone.text(3)};
    const auto key = [](const Tombstone& t) { return std::tie(t.withdrawn_utc, t.station); };
    const auto [known, fresh] = content.tombstones.try_emplace(found.person, found);
    if (!fresh && key(found) < key(known->second)) known->second = found;
  }
  content.sources.push_back(std::move(source));
}

std::vector<SessionCopy> choose_sessions(Content& content) {
  std::map<std::string, SessionCopy> furthest;
  for (const SessionCopy& copy : content.copies) {
    if (content.tombstones.contains(copy.person)) continue;
    const auto [known, fresh] = furthest.try_emplace(copy.uid, copy);
    if (fresh) continue;
    const bool later = less_far(known->second, copy);
    check_earlier(content, later ? known->second : copy, later ? copy : known->second);
    if (later) known->second = copy;
  }
  std::vector<SessionCopy> chosen;
  for (auto& [uid, copy] : furthest) chosen.push_back(std::move(copy));
  const auto key = [](const SessionCopy& c) {
    return std::tie(c.planned_utc, c.run_uid, c.code, c.visit, c.uid);
  };
  std::sort(chosen.begin(), chosen.end(),
            [&](const SessionCopy& a, const SessionCopy& b) { return key(a) < key(b); });
  check_visits(content, chosen);
  return chosen;
}

namespace {

constexpr std::size_t longest_code = 32;
constexpr std::size_t digits = 4;

struct Person {
  std::string uid, code, station;
};

/// All people, each with the code and station of the person's first session or, for a person who withdrew, of
/// the tombstone.
std::vector<Person> people_of(const Content& content) {
  std::map<std::string, Person> people;
  // By person: planned_utc and uid of the person's first session.
  std::map<std::string, std::pair<std::string, std::string>> first;
  for (const SessionCopy& copy : content.copies) {
    const std::pair key{copy.planned_utc, copy.uid};
    const auto [known, fresh] = first.try_emplace(copy.person, key);
    if (!fresh && known->second <= key) continue;
    known->second = key;
    people[copy.person] = {copy.person, copy.code, copy.station};
  }
  for (const auto& [uid, stone] : content.tombstones) people[uid] = {uid, stone.code, stone.station};
  std::vector<Person> out;
  for (auto& [uid, person] : people) out.push_back(std::move(person));
  return out;
}

std::string as_code(std::string text) {
  for (char& c : text) {
    const bool allowed =
        (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    if (!allowed) c = '-';
  }
  return text;
}

std::string with_digits(const Person& person) {
  return person.code.substr(0, longest_code - digits - 1) + '-' +
         base::sha256_hex(person.uid).substr(0, digits);
}

/// The code "<code>-<station>"; if there is no station or the result is too long, "<code>-<digits of a hash>"
/// (with_digits()).
std::string with_station(const Person& person) {
  const std::string name = person.code + '-' + as_code(person.station);
  return person.station.empty() || name.size() > longest_code ? with_digits(person) : name;
}

}  // namespace

std::map<std::string, std::string> name_people(const Content& content) {
  const auto people = people_of(content);
  std::map<std::string, int> given, taken;
  for (const Person& person : people) ++given[person.code];
  const auto wished = [&](const Person& person) {
    return given[person.code] == 1 ? person.code : with_station(person);
  };
  for (const Person& person : people) ++taken[wished(person)];
  std::map<std::string, std::string> names;
  std::set<std::string> distinct;
  for (const Person& person : people) {
    const bool alone = given[person.code] == 1 || taken[wished(person)] == 1;
    const std::string name = alone ? wished(person) : with_digits(person);
    if (!distinct.insert(name).second) {
      throw base::Error("participant code " + person.code, "cannot be made distinct from another",
                        "merge fewer databases at a time");
    }
    names[person.uid] = name;
  }
  return names;
}

namespace {

/// The sessions in one source with the same protocol and station number that count as uses of their slots.
struct Dealt {
  std::size_t source = 0;
  std::optional<StationNumber> number;
  std::set<std::string> sessions;  ///< column session.uid of each session
};

std::vector<Dealt> dealt_by_sources(const Content& content, const std::string& protocol) {
  std::vector<Dealt> all;
  for (const SessionCopy& copy : content.copies) {
    if (!copy.counts || copy.reserved || copy.protocol_sha256 != protocol ||
        content.tombstones.contains(copy.person))
      continue;
    const auto same = [&](const Dealt& one) {
      return one.source == copy.source && one.number == copy.station_number;
    };
    auto found = std::find_if(all.begin(), all.end(), same);
    if (found == all.end()) found = all.insert(all.end(), Dealt{copy.source, copy.station_number, {}});
    found->sessions.insert(copy.uid);
  }
  return all;
}

/// True if `a` and `b` each have a session that the other lacks. Otherwise one of them may be an earlier copy
/// of the other.
bool went_apart(const Dealt& a, const Dealt& b) {
  const auto holds = [](const Dealt& one, const Dealt& other) {
    return std::includes(one.sessions.begin(), one.sessions.end(), other.sessions.begin(),
                         other.sessions.end());
  };
  return !holds(a, b) && !holds(b, a);
}

std::string files_of(const Content& content, const Dealt& a, const Dealt& b) {
  const auto file = [&](const Dealt& one) { return content.sources[one.source]->path().string(); };
  return a.source == b.source ? file(a) : file(a) + " and " + file(b);
}

/// Describes why the sessions of `a` and `b` may have been assigned the same slots (positions in the
/// counterbalancing); empty if nothing shows that.
std::string trouble_of(const Content& content, const Dealt& a, const Dealt& b) {
  const std::string files = files_of(content, a, b);
  if (a.source != b.source && a.number == b.number && went_apart(a, b))
    return files +
           (a.number ? " were both recorded as station " + station_text(*a.number)
                     : " have sessions without a station number") +
           ": they used the same slots of the assignment";
  if (a.number && b.number && a.number->count != b.number->count)
    return files + ": sessions were recorded as stations " + station_text(*a.number) + " and " +
           station_text(*b.number) + ", whose shares overlap";
  if (a.number.has_value() != b.number.has_value())
    return files + ": some sessions were recorded as station " +
           station_text(a.number ? *a.number : *b.number) +
           ", others without a station number: their shares overlap";
  return {};
}

}  // namespace

std::vector<std::string> station_troubles(const Content& content) {
  std::set<std::string> protocols, troubles;
  for (const SessionCopy& copy : content.copies) protocols.insert(copy.protocol_sha256);
  for (const std::string& protocol : protocols) {
    const auto all = dealt_by_sources(content, protocol);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = i + 1; j < all.size(); ++j) {
        if (const auto trouble = trouble_of(content, all[i], all[j]); !trouble.empty())
          troubles.insert(trouble);
      }
    }
  }
  return {troubles.begin(), troubles.end()};
}

}  // namespace study::merging
