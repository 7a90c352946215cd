#pragma once
/// A PostgreSQL server for tests, with data, socket and service file in a folder of its own.

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "tests/common/temporary_folder.hpp"

namespace test {

/// A server that ends with the test program, also if the program is killed. Roles connect without a password
/// over the socket, and with one (scram-sha-256) over 127.0.0.1. The role of the administrator is "postgres".
/// std::runtime_error if PostgreSQL is missing (scripts/setup.sh tools) or does not start.
class PostgresServer {
 public:
  /// Makes the data folder (initdb), starts the server and points PGSERVICEFILE to its service file.
  PostgresServer();
  ~PostgresServer();
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  void start();
  /// As pg_ctl stop -m immediate: every session ends at once, and the next start recovers from the log.
  void stop_immediately();
  /// Adds the service `name` to the service file: `role` at `database` over the socket. `more`: further
  /// lines, such as "host=127.0.0.1", which replace the usual ones.
  void add_service(const std::string& name, const std::string& role, const std::string& database,
                   const std::string& more = "");
  /// Runs SQL as the administrator, with psql; returns what it prints, a row a line, columns parted by "|".
  /// std::runtime_error if it fails.
  std::string sql(const std::string& database, const std::string& text) const;
  int port() const { return port_; }
  std::filesystem::path folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
  std::filesystem::path programs_;
  int port_ = 0;
  pid_t server_ = 0;
  const pid_t maker_;
};

/// The server of this test program, made at the first call.
PostgresServer& postgres_server();

}  // namespace test
