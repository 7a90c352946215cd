#pragma once
/// A central database with stations and readers, on the PostgreSQL server of the tests.

#include <filesystem>
#include <string>

#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/open_study.hpp"
#include "tests/common/postgres_server.hpp"

namespace study::test {

using namespace ::test;

/// A new central database. Roles and services begin with its name, which is `name` and a number.
class CentralWorld {
 public:
  explicit CentralWorld(const std::string& name) : name_(numbered(name)), groups_(name_) {
    auto& server = postgres_server();
    server.sql("postgres", "CREATE DATABASE " + name_);
    for (const std::string& group : {groups_.station, groups_.lab_reader, groups_.shared_reader})
      server.sql("postgres", "CREATE ROLE " + group + " NOLOGIN");
    server.add_service(name_ + "_owner", "postgres", name_);
    pg::Connection(name_ + "_owner").script(central::make_sql(groups_));
  }

  /// Makes a role and its service; returns the service.
  std::string station(const std::string& who) { return role(who, groups_.station); }
  std::string reader(const std::string& who) { return role(who, groups_.lab_reader); }
  std::string shared_reader(const std::string& who) { return role(who, groups_.shared_reader); }

  /// What SQL gives, as the owner.
  std::string sql(const std::string& text) const { return postgres_server().sql(name_, text); }

 private:
  static std::string numbered(const std::string& name) {
    static int worlds = 0;
    return name + std::to_string(++worlds);
  }

  std::string role(const std::string& who, const std::string& group) {
    const std::string role = name_ + "_" + who;
    postgres_server().sql("postgres", "CREATE ROLE " + role + " LOGIN IN ROLE " + group);
    postgres_server().add_service(role, role, name_);
    return role;
  }

  std::string name_;
  central::Groups groups_;
};

/// Sends all rows of a station, in place of those that it sent before.
inline void send_all(const std::string& service, const std::filesystem::path& path) {
  const auto file = open_study(path).database;
  pg::Connection central(service);
  pg::Transaction transaction(central);
  const auto send = [&](const central::Table& table, std::int64_t id, const std::string& uid) {
    sqlite::Statement row(*file, central::select_sql(table));
    const int parameters = table.scope == central::Scope::Person    ? 0
                           : table.scope == central::Scope::Session ? 2
                                                                    : 1;
    if (parameters > 0) row.bind_at(0, id);
    if (parameters > 1) row.bind_at(1, uid);
    while (row.step()) {
      std::vector<pg::Field> values;
      std::string places;
      for (int i = 0; i < row.columns(); ++i) {
        places += (places.empty() ? "$" : ", $") + std::to_string(i + 1);
        if (row.is_null(i))
          values.push_back({});
        else if (row.is_real(i))
          values.push_back(pg::text_of(row.real(i)));
        else
          values.push_back(row.text(i));
      }
      central.run("INSERT INTO vip." + pg::quoted_name(table.name) + " (" + central::column_list(table) +
                      ") VALUES (" + places + ") ON CONFLICT DO NOTHING",
                  values);
    }
  };
  const auto each = [&](const char* sql, const auto& take) {
    for (sqlite::Statement row(*file, sql); row.step();) take(row);
  };
  using central::Scope;
  for (const central::Table& table : central::tables())
    if (table.name == "tombstone") send(table, 0, "");
  each("SELECT protocol_id FROM protocol", [&](const auto& row) {
    for (const central::Table& table : central::tables())
      if (table.scope == Scope::Protocol) send(table, row.integer(0), "");
  });
  each("SELECT run_id FROM run", [&](const auto& row) { send(central::table("run"), row.integer(0), ""); });
  for (const central::Table& table : central::tables())
    if (table.scope == Scope::Session) central.run("DELETE FROM vip." + pg::quoted_name(table.name));
  each("SELECT session_id, uid FROM session", [&](const auto& row) {
    for (const central::Table& table : central::tables()) {
      if (table.scope != Scope::Session) continue;
      if (!table.large) {
        send(table, row.integer(0), row.text(1));
        continue;
      }
      sqlite::Statement shown(*file,
                              "SELECT presentation_id FROM presentation JOIN trial USING (trial_id) WHERE "
                              "session_id = ?");
      for (shown.bind_all(row.integer(0)); shown.step();) send(table, shown.integer(0), row.text(1));
    }
  });
  transaction.commit();
}

}  // namespace study::test
