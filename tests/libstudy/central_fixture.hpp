#pragma once
/// A lab with a central database, for tests. Its owner is no superuser.

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "libstudy/store/central/central_admin.hpp"
#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/push/push.hpp"
#include "libstudy/store/push/session_copy.hpp"
#include "tests/common/postgres_server.hpp"

namespace study::test {

/// The central database `name`, with services of its owner (`name`) and of the administrator (`name`_admin).
class Lab {
 public:
  explicit Lab(const std::string& name) : name_(name) {
    auto& server = ::test::postgres_server();
    server.sql("postgres", "CREATE ROLE " + name + "_owner LOGIN CREATEROLE");
    server.sql("postgres", "CREATE DATABASE " + name + " OWNER " + name + "_owner");
    server.add_service(name, name + "_owner", name);
    server.add_service(name + "_admin", "postgres", name);
    central::init(name);
  }
  const std::string& service() const { return name_; }

  /// Admits a new role; returns its name, which is its service too.
  std::string admit(const std::string& role, central::Admission admission = central::Admission::Station) {
    const std::string full = name_ + "_" + role;
    ask("CREATE ROLE " + full + " LOGIN");
    ::test::postgres_server().add_service(full, full, name_);
    central::admit(name_, full, admission);
    return full;
  }

  /// The first column of a query as the administrator, who sees every row.
  std::vector<std::string> ask(const std::string& sql) const { return ask_as(name_ + "_admin", sql); }
  static std::vector<std::string> ask_as(const std::string& service, const std::string& sql) {
    const auto rows = connected(service, [&](pg::Connection& centre) { return centre.run(sql); });
    std::vector<std::string> out;
    for (int i = 0; i < rows.size(); ++i) out.push_back(rows.at(i, 0).value_or("~"));
    return out;
  }

  /// Every row that a station sent, as sorted lines. tables: those of a session or a person only, because the
  /// others stay when their sessions go.
  std::vector<std::string> rows_of(const std::string& station) const {
    return connected(name_ + "_admin", [&](pg::Connection& centre) {
      std::vector<std::string> lines;
      for (const central::Table& table : central::tables()) {
        centre.copy_out("COPY (SELECT " + central::column_list(table) + " FROM vip." +
                            pg::quoted_name(table.name) + " WHERE sender = " + pg::quoted_text(station) +
                            ") TO STDOUT",
                        [&](const pg::Row& row) { lines.push_back(line_of(table, row)); });
      }
      std::sort(lines.begin(), lines.end());
      return lines;
    });
  }

  /// Every row of a station's file that belongs at the centre, in the same form.
  static std::vector<std::string> rows_of_file(const std::filesystem::path& path) {
    const auto file = open_study(path).database;
    std::set<std::string> lines;
    const auto add = [&](const pushing::TableRows& rows) {
      for (const pg::Row& row : rows.rows) lines.insert(line_of(*rows.table, row));
    };
    for (const central::Table& table : central::tables()) {
      if (table.scope == central::Scope::Person) add(pushing::read_rows(*file, table));
    }
    for (const pushing::LocalSession& session : pushing::read_sessions(*file)) {
      const pushing::Core core = pushing::read_core(*file, session);
      for (const pushing::TableRows& rows : core.tables) add(rows);
      add(core.changes);
      add(core.change_events);
      for (const central::Table& table : central::tables()) {
        if (table.scope == central::Scope::Protocol)
          add(pushing::read_rows(*file, table, session.protocol_id));
        if (table.scope == central::Scope::Run) add(pushing::read_rows(*file, table, session.run_id));
        for (const pushing::Showing& showing : core.showings)
          if (table.large) add(pushing::read_large(*file, table, session, showing));
      }
    }
    return {lines.begin(), lines.end()};
  }

 private:
  static std::string line_of(const central::Table& table, const pg::Row& row) {
    std::string line = table.name + "\t";
    pg::append_line(row, line);
    return line;
  }

  /// Calls `work` with a connection that is kept, because each takes the server some hundredths of a second.
  template <class Work>
  static std::invoke_result_t<Work, pg::Connection&> connected(const std::string& service, const Work& work) {
    static std::map<std::string, std::unique_ptr<pg::Connection>> kept;
    auto& connection = kept[service];
    try {
      if (connection) return work(*connection);
    } catch (const pg::Failure& failure) {
      if (!failure.lost()) throw;  // lost: another test stopped the server
    }
    connection = std::make_unique<pg::Connection>(service);
    return work(*connection);
  }

  std::string name_;
};

/// The lab of this test program, made at the first call.
inline Lab& lab() {
  static Lab made("lab");
  return made;
}

template <class Work>
std::string message_of(const Work& work) {
  try {
    work();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing was thrown";
}

}  // namespace study::test
