#pragma once
/// Helpers for end-to-end tests of vip-study: a folder, readers of a database.

#include <map>
#include <set>
#include <tuple>

#include "libstudy/store/file/sqlite.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/protocols.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps::test {

namespace fs = std::filesystem;

inline const std::string vip_study = VIP_BIN_DIR "/vip-study";

using namespace ::test;

inline std::vector<std::string> run_arguments(const std::string& protocol, const std::string& database,
                                              const std::vector<std::string>& more) {
  std::vector<std::string> arguments{
      vip_study,           "run",     protocol, "--db", database, "--seed", "7", "--observer",
      "ptpe:a=31,b=0.035", "--events"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// (participant, position of the unit, question) -> (response row, score, time of the answer).
using AnswerKey = std::tuple<std::string, int, std::string>;
using Answers = std::map<AnswerKey, std::tuple<std::int64_t, int, std::string>>;

inline Answers answers_in(const std::string& database) {
  study::sqlite::Connection connection(database, study::sqlite::Open::Read);
  study::sqlite::Statement row(
      connection,
      "SELECT s.participant, u.position, q.code, r.response_id, r.score, r.answered_utc FROM response r "
      "JOIN unit u USING (unit_id) JOIN session s USING (session_id) JOIN question q USING (question_id)");
  Answers answers;
  while (row.step()) {
    answers[{row.text(0), static_cast<int>(row.integer(1)), row.text(2)}] = {
        row.integer(3), static_cast<int>(row.integer(4)), row.text(5)};
  }
  return answers;
}

inline std::int64_t count_in(const std::string& database, const std::string& sql) {
  return study::sqlite::Connection(database, study::sqlite::Open::Read).integer(sql);
}

/// (participant, position) of every unit that the database lists as done.
using Units = std::set<std::pair<std::string, int>>;

inline Units done_in(const std::string& database) {
  study::sqlite::Connection connection(database, study::sqlite::Open::Read);
  study::sqlite::Statement row(
      connection,
      "SELECT s.participant, u.position FROM unit u JOIN session s USING (session_id) "
      "WHERE u.state = 'done'");
  Units units;
  while (row.step()) units.emplace(row.text(0), static_cast<int>(row.integer(1)));
  return units;
}

/// The units that the program reported as committed, from lines such as "done P01 3 stimulus attempt 1".
inline std::vector<std::pair<std::string, int>> acknowledged(const std::string& out) {
  std::vector<std::pair<std::string, int>> all;
  std::size_t at = 0;
  while (at < out.size()) {
    const std::size_t end = std::min(out.find('\n', at), out.size());
    char participant[40];
    int position = 0;
    if (std::sscanf(out.substr(at, end - at).c_str(), "done %39s %d", participant, &position) == 2) {
      all.emplace_back(participant, position);
    }
    at = end + 1;
  }
  return all;
}

}  // namespace apps::test
