#pragma once
/// A database as the first version wrote it, with rows in every table.

#include <filesystem>
#include <string>

#include "libstudy/store/file/database.hpp"

namespace study::test {

/// P01 answered every trial. The participant `second` answered one of two trials, and the other trial was
/// interrupted.
inline void write_version_1(const std::filesystem::path& path, const std::string& second = "P02") {
  const auto database = open_database(path, sqlite::Open::Create, {read_schema_steps().front()});
  database->execute(
      "INSERT INTO protocol VALUES (1, '" + std::string(64, 'a') +
      "', 'pilot', '1.0', 'format = 1', NULL, 0);"
      "INSERT INTO question VALUES (1, 1, 'satisfaction', 'How satisfied?', 'en', 1, 7, '1 = very "
      "dissatisfied');"
      "INSERT INTO run VALUES (1, '2026-01-02T03:04:05Z', '0.1.0', '{}');"
      "INSERT INTO session VALUES (1, 1, 1, 'P01', 1, 7, 0, 'ptpe', 'virtual', 'none', 'nothing', 'machine', "
      "'UTC', "
      "'ptpe file', '2026-01-02T03:05:00Z', '2026-01-02T03:10:00Z');"
      "INSERT INTO session VALUES (2, 1, 1, '" +
      second +
      "', 1, 8, 0, NULL, 'real', 'none', 'nothing', 'machine', 'UTC', NULL, '2026-01-02T04:05:00Z', NULL);"
      "INSERT INTO trial VALUES (1, 1, 0, 1, 0, 20, 5, 10, -9, 'answered');"
      "INSERT INTO trial VALUES (2, 1, 1, 0, 0, 10, 0, 10, 9, 'answered');"
      "INSERT INTO trial VALUES (3, 2, 0, 0, 1, 10, 0, 10, 11, 'answered');"
      "INSERT INTO trial VALUES (4, 2, 1, 1, 0, 20, 5, 10, 12, 'planned');");
  // Trial 1 was interrupted and shown again; the interruption of trial 4 ended the session.
  const std::string moments = "10, 20, 20.5, 5, 80, 90, 15, 0.5, 1, 2.5";
  database->execute(
      "INSERT INTO presentation VALUES (1, 1, 1, 'interrupted', 't', 5, " +
      std::string("NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL);") +
      "INSERT INTO presentation VALUES (2, 1, 2, 'played', 't', 50, 60, 'pass', 'D', '', " + moments +
      ");"
      "INSERT INTO presentation VALUES (3, 2, 1, 'played', 't', 70, 80, 'fail', 'B', 'late', " +
      moments +
      ");"
      "INSERT INTO presentation VALUES (4, 3, 1, 'played', 't', 1234605616436508552, 80, 'degraded', 'D', "
      "'x', " +
      moments +
      ");"
      "INSERT INTO presentation VALUES (5, 4, 1, 'interrupted', 't', 1234605616436508552, " +
      std::string("NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL);") +
      "INSERT INTO frame SELECT p.presentation_id, f.value, 1, 0.5, 20, 1, 2, 3, 4, 0, '1 2', 0.5, -1 "
      "FROM presentation p JOIN (SELECT 0 AS value UNION SELECT 1) f;"
      "INSERT INTO response VALUES (1, 1, 2, 1, 5, 1.5, '2026-01-02T03:09:00Z');"
      "INSERT INTO response VALUES (2, 2, 3, 1, 2, 2.5, '2026-01-02T03:10:00Z');"
      "INSERT INTO response VALUES (3, 3, 4, 1, 7, 3.5, '2026-01-02T04:10:00Z');"
      "INSERT INTO event VALUES (1, NULL, NULL, 't', NULL, 'made', '');"
      "INSERT INTO event VALUES (2, 1, 2, 't', 50, 'answered', '');"
      "INSERT INTO event VALUES (3, 2, 4, 't', 70, 'answered', '');");
}

}  // namespace study::test
