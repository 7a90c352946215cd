#include "libstudy/store/central/central_admin.hpp"

#include <algorithm>
#include <map>

#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study::central {

using pg::Connection;
using pg::quoted_name;
using pg::Transaction;

namespace {

[[noreturn]] void refuse_work(const Connection& central, const std::string& problem,
                              const std::string& mend) {
  throw base::Error("service " + central.service(), problem, mend);
}

std::string database_of(Connection& central) { return central.run("SELECT current_database()").text(0, 0); }

bool has_vip(Connection& central) {
  return central.run("SELECT 1 FROM pg_namespace WHERE nspname = 'vip'").size() > 0;
}

void check_owner(Connection& central) {
  const auto owner = central.run(
      "SELECT pg_get_userbyid(datdba), current_user, pg_encoding_to_char(encoding) FROM pg_database WHERE "
      "datname = current_database()");
  if (owner.text(0, 0) != owner.text(0, 1)) {
    refuse_work(central, "its role '" + base::shortened(owner.text(0, 1)) + "' does not own the database",
                "give the service the user '" + base::shortened(owner.text(0, 0)) + "'");
  }
  if (owner.text(0, 2) != "UTF8")
    refuse_work(central, "its database has the encoding " + owner.text(0, 2),
                "make a database with ENCODING 'UTF8'");
}

void make_groups(Connection& central, const Groups& groups) {
  std::string statements;
  for (const std::string& group : {groups.station, groups.lab_reader, groups.shared_reader}) {
    if (central.run("SELECT 1 FROM pg_roles WHERE rolname = $1", {group}).size() == 0)
      statements += "CREATE ROLE " + quoted_name(group) + " NOLOGIN; ";
  }
  if (statements.empty()) return;
  if (central.run("SELECT 1 FROM pg_roles WHERE rolname = current_user AND (rolcreaterole OR rolsuper)")
          .size() == 0) {
    refuse_work(central, "its role may not create roles",
                "give this to an administrator of the server, then repeat the command: " + statements);
  }
  central.script(statements);
}

/// Nobody but the groups connects, and nobody makes objects.
std::string closed_sql(const std::string& database, const Groups& groups) {
  const std::string name = quoted_name(database);
  return "REVOKE ALL ON DATABASE " + name + " FROM PUBLIC; REVOKE ALL ON SCHEMA public FROM PUBLIC; " +
         "GRANT CONNECT ON DATABASE " + name + " TO " + quoted_name(groups.station) + ", " +
         quoted_name(groups.lab_reader) + ", " + quoted_name(groups.shared_reader) + ";\n";
}

struct StandingColumn {
  std::string type;
  bool not_null = false;
};
using StandingTables = std::map<std::string, std::map<std::string, StandingColumn>>;

StandingTables standing_tables(Connection& central) {
  const auto rows = central.run(
      "SELECT c.relname, a.attname, format_type(a.atttypid, a.atttypmod), a.attnotnull FROM pg_class c "
      "JOIN pg_namespace n ON n.oid = c.relnamespace JOIN pg_attribute a ON a.attrelid = c.oid "
      "WHERE n.nspname = 'vip' AND c.relkind = 'r' AND a.attnum > 0 AND NOT a.attisdropped");
  StandingTables found;
  for (int i = 0; i < rows.size(); ++i)
    found[rows.text(i, 0)][rows.text(i, 1)] = {rows.text(i, 2), rows.text(i, 3) == "t"};
  return found;
}

/// The columns of a table's primary key as text, for comparison.
std::string standing_key(Connection& central, const std::string& table) {
  return central
      .run(
          "SELECT string_agg(a.attname, ',' ORDER BY a.attname) FROM pg_constraint k JOIN pg_attribute a ON "
          "a.attrelid = k.conrelid AND a.attnum = ANY (k.conkey) WHERE k.contype = 'p' AND k.conrelid = "
          "$1::regclass",
          {"vip." + quoted_name(table)})
      .text(0, 0);
}

std::string wanted_key(const Table& table) {
  std::vector<std::string> names = table.key;
  names.emplace_back("sender");
  std::sort(names.begin(), names.end());
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ",") + name;
  return list;
}

[[noreturn]] void refuse_step(const Connection& central, const std::string& problem) {
  refuse_work(central, "cannot be upgraded: " + problem,
              "make a new database with vip-study central init, and push every station's file to it");
}

/// Adds the columns of a table that stands; notes them in `added`.
void add_columns(Connection& central, const Table& table, std::map<std::string, StandingColumn> standing,
                 std::vector<std::string>& added) {
  standing.erase("sender");
  for (const Column& column : table.columns) {
    const std::string name = table.name + "." + column.name;
    const auto there = standing.find(column.name);
    if (there == standing.end()) {
      if (column.not_null) refuse_step(central, "the new column " + name + " may not be empty");
      central.script("ALTER TABLE vip." + quoted_name(table.name) + " ADD COLUMN " + column_sql(column));
      added.push_back(name);
      continue;
    }
    if (there->second.type != column.type)
      refuse_step(central, name + " changes from " + there->second.type + " to " + column.type);
    if (there->second.not_null != column.not_null) {
      if (column.not_null) refuse_step(central, name + " may not be empty any more");
      central.script("ALTER TABLE vip." + quoted_name(table.name) + " ALTER COLUMN " +
                     quoted_name(column.name) + " DROP NOT NULL");
    }
    standing.erase(there);
  }
  if (!standing.empty())
    refuse_step(central, "the column " + table.name + "." + standing.begin()->first + " is gone");
  if (standing_key(central, table.name) != wanted_key(table))
    refuse_step(central, "the table " + table.name + " has another key");
}

}  // namespace

void init(const std::string& service) {
  Connection central(service);
  check_owner(central);
  if (has_vip(central))
    refuse_work(central, "its database has a schema vip", "upgrade it with vip-study central upgrade");
  const std::string database = database_of(central);
  const Groups groups(database);
  Transaction transaction(central);
  make_groups(central, groups);
  central.script(make_sql(groups) + closed_sql(database, groups));
  transaction.commit();
}

Upgrade upgrade(const std::string& service) {
  Connection central(service);
  check_owner(central);
  if (!has_vip(central)) refuse_work(central, "its database is empty", "make it with vip-study central init");
  Upgrade done;
  done.now = schema_number();
  Transaction transaction(central);
  central.script("LOCK TABLE vip.schema_version IN ACCESS EXCLUSIVE MODE");
  done.before = central.run("SELECT number FROM vip.schema_version").integer(0, 0);
  if (done.before > done.now)
    refuse_work(central,
                "its database has the schema " + std::to_string(done.before) + ", this program " +
                    std::to_string(done.now),
                "use a newer vip-study");
  StandingTables standing = standing_tables(central);
  for (const char* own : {"part", "schema_version", "reservation", "slot_count"}) standing.erase(own);
  for (const Table* one : in_order()) {
    const auto there = standing.find(one->name);
    if (there == standing.end()) {
      central.script(table_sql(*one));
      done.added.push_back(one->name);
      continue;
    }
    add_columns(central, *one, there->second, done.added);
    standing.erase(there);
  }
  if (!standing.empty()) refuse_step(central, "the table " + standing.begin()->first + " is gone");
  central.script(remake_sql(Groups(database_of(central))));
  central.run("UPDATE vip.schema_version SET number = $1", {pg::text_of(done.now)});
  transaction.commit();
  return done;
}

void admit(const std::string& service, const std::string& role, Admission admission) {
  Connection central(service);
  check_owner(central);
  if (!has_vip(central)) refuse_work(central, "its database is empty", "make it with vip-study central init");
  const Groups groups(database_of(central));
  const auto found = central.run(
      "SELECT rolcanlogin, rolsuper OR rolbypassrls OR rolcreaterole OR rolname = current_user FROM pg_roles "
      "WHERE rolname = $1",
      {role});
  const std::string shown = "'" + base::shortened(role) + "'";
  if (found.size() == 0 || found.text(0, 0) != "t") {
    refuse_work(central, "has no role " + shown + " that may log in",
                "let an administrator of the server make it: createuser -P " + base::shortened(role));
  }
  if (found.text(0, 1) == "t")
    refuse_work(central, "the role " + shown + " owns the database, is a superuser or may create roles",
                "give each station and each reader a plain role of its own");
  const std::map<Admission, std::string> names{{Admission::Station, groups.station},
                                               {Admission::LabReader, groups.lab_reader},
                                               {Admission::SharedReader, groups.shared_reader}};
  for (const auto& [other, group] : names) {
    if (other != admission &&
        central.run("SELECT pg_has_role($1, $2, 'member')", {role, group}).text(0, 0) == "t")
      refuse_work(
          central, "the role " + shown + " is a member of " + group,
          "use another role, or take it out: REVOKE " + quoted_name(group) + " FROM " + quoted_name(role));
  }
  central.script("GRANT " + quoted_name(names.at(admission)) + " TO " + quoted_name(role));
}

}  // namespace study::central
