/// The SQL that makes and upgrades the central database.
#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study::central {

namespace {

constexpr std::size_t most_sql_bytes = 1 << 20;
constexpr std::size_t longest_role = 63;

// Tables of gaze data, as in refusals.cpp.
const std::set<std::string> gaze_of_showings{"gaze", "head"};
const std::string gaze_of_sessions = "gaze_validation";

std::string name_list(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + pg::quoted_name(name);
  return list;
}

/// A key with the sender, which is in every key.
std::string with_sender(const std::vector<std::string>& names) {
  std::vector<std::string> all = names;
  all.insert(all.begin() + 1, "sender");
  return "(" + name_list(all) + ")";
}

std::string full_name(const Table& table) { return "vip." + pg::quoted_name(table.name); }

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

int depth_of(const Table& one) {
  int depth = 0;
  for (const Reference& reference : one.references) {
    const Table& parent = table(reference.table);
    if (parent.scope == Scope::Session) depth = std::max(depth, 1 + depth_of(parent));
  }
  return depth;
}

/// DELETE statements for the rows of one session below it, parents first.
std::string bury_sql() {
  std::vector<const Table*> below;
  for (const Table& one : tables()) {
    if (one.scope == Scope::Session && one.name != "session") below.push_back(&one);
  }
  std::stable_sort(below.begin(), below.end(),
                   [](const Table* a, const Table* b) { return depth_of(*a) < depth_of(*b); });
  std::string sql;
  for (const Table* one : below)
    sql += "DELETE FROM " + full_name(*one) +
           " t WHERE t.session_uid = gone.session_uid AND t.sender = gone.sender;\n    ";
  return sql;
}

/// A station's rights: rows of its own, which it replaces by deleting and inserting. What says that a person
/// withdrew, and what several sessions share, is never deleted.
std::string rights_sql(const std::string& name, const std::string& rights, const Groups& groups) {
  const std::string station = pg::quoted_name(groups.station), table = "vip." + pg::quoted_name(name);
  return "ALTER TABLE " + table + " ENABLE ROW LEVEL SECURITY;\nDROP POLICY IF EXISTS own_rows ON " + table +
         ";\nCREATE POLICY own_rows ON " + table + " TO " + station +
         " USING (sender = session_user::text) WITH CHECK (sender = session_user::text);\n" +
         "REVOKE ALL ON " + table + " FROM PUBLIC, " + station + ";\nGRANT " + rights + " ON " + table +
         " TO " + station + ";\n";
}

std::string checks_sql(const Table& one) {
  const std::string loop =
      "DO $do$ DECLARE c text; BEGIN FOR c IN SELECT conname FROM pg_catalog.pg_constraint WHERE contype = "
      "'c' "
      "AND conrelid = '" +
      full_name(one) + "'::regclass LOOP EXECUTE format('ALTER TABLE " + full_name(one) +
      " DROP CONSTRAINT %I', c); END LOOP; END $do$;\n";
  std::string sql = loop;
  for (const std::string& check : one.checks)
    sql += "ALTER TABLE " + full_name(one) + " ADD CHECK (" + check + ");\n";
  return sql;
}

/// Rows of a table, alias t, that a reader may see. sessions: the view of the sessions that it may see.
std::string shown_sql(const Table& one, const std::string& sessions) {
  const auto of = [](const std::string& view, const std::string& columns) {
    return "(" + columns + ") IN (SELECT " + columns + " FROM vip." + view + ")";
  };
  const bool shared = sessions == "shareable";
  if (one.name == "tombstone" || one.name == "note") {
    if (shared) return "false";  // codes of people who withdrew; free words
    if (one.name == "tombstone") return "true";
  }
  if (one.name == "label")
    return "t.kind <> 'person' OR t.owner IN (SELECT person FROM vip." + sessions + ")";
  if (one.scope == Scope::Protocol) return "true";
  if (one.scope == Scope::Run) return of(sessions, "run_uid, sender");
  std::string rows = of(sessions, "session_uid, sender");
  if (gaze_of_showings.contains(one.name))
    rows += " AND " + of("gaze_showing", "session_uid, sender, presentation_id");
  if (one.name == gaze_of_sessions) rows += " AND " + of("gaze_session", "session_uid, sender");
  return rows;
}

std::string view_sql(const Table& one, const std::string& schema, const std::string& sessions) {
  std::string columns = "t.sender";
  for (const Column& column : one.columns) {
    const bool words = schema == "shared" && one.name == "response" && column.name == "words";
    columns += words ? ", NULL::text AS words" : ", t." + pg::quoted_name(column.name);
  }
  return "CREATE VIEW " + schema + "." + pg::quoted_name(one.name) + " WITH (security_barrier) AS SELECT " +
         columns + " FROM " + full_name(one) + " t WHERE " + shown_sql(one, sessions) + ";\n";
}

std::string views_sql(const std::string& schema, const std::string& sessions, const std::string& group) {
  std::string sql = "DROP SCHEMA IF EXISTS " + schema + " CASCADE;\nCREATE SCHEMA " + schema + ";\n";
  for (const Table& one : tables()) sql += view_sql(one, schema, sessions);
  sql += "CREATE VIEW " + schema + ".schema_version AS SELECT number FROM vip.schema_version;\n";
  return sql + "GRANT USAGE ON SCHEMA " + schema + " TO " + pg::quoted_name(group) +
         ";\nGRANT SELECT ON ALL TABLES IN SCHEMA " + schema + " TO " + pg::quoted_name(group) + ";\n";
}

/// The ledger of what was pushed, and the number of the schema.
const std::string own_tables_sql =
    "CREATE TABLE vip.schema_version (number bigint NOT NULL);\n"
    "CREATE TABLE vip.part (\n"
    "  of text NOT NULL,\n"  // session_uid, protocol_sha256 or 'labels'
    "  sender text NOT NULL DEFAULT session_user,\n"
    "  part text NOT NULL,\n"  // 'core', or a large table and a presentation_id
    "  sha256 text NOT NULL CHECK (length(sha256) = 64),\n"
    "  rows bigint NOT NULL,\n"  // rows of the part
    "  events bigint,\n"         // core: events of the session, without changes of permissions
    "  log_sha256 text,\n"       // core: digest of these events
    "  progress bigint,\n"       // core: rows and states that only grow
    "  pushed_utc timestamptz NOT NULL DEFAULT now(),\n"
    "  PRIMARY KEY (of, sender, part));\n";

}  // namespace

Groups::Groups(const std::string& database)
    : station(database + "_station"),
      lab_reader(database + "_lab_reader"),
      shared_reader(database + "_shared_reader") {
  if (shared_reader.size() <= longest_role) return;
  throw base::Error("database " + database,
                    "has a name of more than 49 bytes, too long for names of its roles",
                    "make a database with a shorter name");
}

std::string column_sql(const Column& column) {
  return pg::quoted_name(column.name) + " " + column.type + (column.not_null ? " NOT NULL" : "");
}

std::string table_sql(const Table& one) {
  std::string sql = "CREATE TABLE " + full_name(one) + " (\n";
  for (const Column& column : one.columns) sql += "  " + column_sql(column) + ",\n";
  sql += "  sender text NOT NULL DEFAULT session_user,\n  PRIMARY KEY " + with_sender(one.key);
  for (const auto& unique : one.uniques) sql += ",\n  UNIQUE " + with_sender(unique);
  // References are tested at the commit, so that rows are replaced in any order.
  for (const Reference& reference : one.references) {
    sql += ",\n  FOREIGN KEY " + with_sender(reference.columns) + " REFERENCES vip." +
           pg::quoted_name(reference.table) + " " + with_sender(reference.keys) +
           " DEFERRABLE INITIALLY DEFERRED";
  }
  return sql + ");\n";
}

std::vector<const Table*> in_order() {
  std::vector<const Table*> rest, order;
  for (const Table& one : tables()) rest.push_back(&one);
  for (std::set<std::string> made; !rest.empty();) {
    const auto next = std::find_if(rest.begin(), rest.end(), [&](const Table* one) {
      return std::all_of(one->references.begin(), one->references.end(),
                         [&](const Reference& to) { return made.contains(to.table); });
    });
    if (next == rest.end()) throw std::logic_error("the tables refer to each other in a circle");
    made.insert((*next)->name);
    order.push_back(*next);
    rest.erase(next);
  }
  return order;
}

std::string make_sql(const Groups& groups) {
  std::string sql = "CREATE SCHEMA vip;\n" + own_tables_sql;
  for (const Table* one : in_order()) sql += table_sql(*one);
  sql += "CREATE INDEX session_of_person ON vip.session (person);\n";
  sql += "INSERT INTO vip.schema_version VALUES (" + std::to_string(schema_number()) + ");\n";
  return sql + remake_sql(groups);
}

std::string remake_sql(const Groups& groups) {
  std::string sql;
  for (const Table& one : tables()) {
    sql += checks_sql(one);
    const bool stays = one.name == "tombstone" || one.scope == Scope::Protocol || one.scope == Scope::Run;
    sql += rights_sql(one.name, stays ? "SELECT, INSERT" : "SELECT, INSERT, DELETE", groups);
  }
  sql += rights_sql("part", "SELECT, INSERT, UPDATE, DELETE", groups);
  std::string own;
  for (const char* file : {"central.sql", "central_slots.sql"})
    own += base::read_file(base::resource(std::string("libstudy/store/sql/") + file), most_sql_bytes);
  replace_all(own, "{bury}", bury_sql());
  replace_all(own, "{station}", pg::quoted_name(groups.station));
  sql += own;
  sql += "REVOKE ALL ON vip.schema_version FROM PUBLIC;\nGRANT SELECT ON vip.schema_version TO " +
         pg::quoted_name(groups.station) + ";\n";
  return sql + views_sql("lab", "chosen", groups.lab_reader) +
         views_sql("shared", "shareable", groups.shared_reader);
}

}  // namespace study::central
