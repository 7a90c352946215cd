/// What a station's role can do at the centre, by any SQL.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

#include "libstudy/store/store.hpp"
#include "tests/libstudy/central_fixture.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// One session with a trial, a note and an excluded trial.
void write_small_study(const fs::path& path, const std::string& participant) {
  Store store(path, sqlite::Open::Create);
  store.add_run(test::run_plan(test::pairs(), {participant}));
  const auto session = store.open_runs().back().sessions.at(0);
  test::answer_one(store, session, session.units.at(1), "ease", test::score(5));
  store.note(session.id, {}, "zebra");
}

/// Two stations, each of which pushed a session.
class CentralRoles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    for (const char* name : {"mine", "theirs"}) {
      write_small_study(*folder_ / (std::string(name) + ".db"), name);
      stations_[name] = test::lab().admit(name);
      push(*folder_ / (std::string(name) + ".db"), stations_[name]);
    }
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string of_theirs(const std::string& column) {
    return test::lab().ask("SELECT " + column + " FROM vip.session WHERE sender = 'lab_theirs'").at(0);
  }

  static test::TemporaryFolder* folder_;
  static std::map<std::string, std::string> stations_;
};
test::TemporaryFolder* CentralRoles::folder_ = nullptr;
std::map<std::string, std::string> CentralRoles::stations_;

TEST_F(CentralRoles, NoStatementReadsOrChangesRowsOfAnother) {
  const auto before = test::lab().rows_of("lab_theirs");
  ASSERT_FALSE(before.empty());
  const std::string uid = pg::quoted_text(of_theirs("session_uid"));
  std::vector<std::string> attacks;
  for (const central::Table& one : central::tables()) {
    const std::string table = "vip." + pg::quoted_name(one.name);
    for (const std::string& sql : {"SELECT t::text FROM " + table + " t WHERE sender <> 'lab_mine'",
                                   "DELETE FROM " + table + " WHERE sender <> 'lab_mine'",
                                   "UPDATE " + table + " SET sender = 'lab_mine'", "TRUNCATE " + table,
                                   "SELECT * FROM lab." + pg::quoted_name(one.name),
                                   "SELECT * FROM shared." + pg::quoted_name(one.name)})
      attacks.push_back(sql);
  }
  const std::vector<std::string> others{
      "DROP TABLE vip.session",
      "ALTER TABLE vip.session DISABLE ROW LEVEL SECURITY",
      "SET row_security = off; SELECT * FROM vip.session",
      "CREATE POLICY p ON vip.session USING (true)",
      "DROP POLICY own_rows ON vip.session",
      "GRANT ALL ON vip.session TO PUBLIC",
      "CREATE TRIGGER t AFTER INSERT ON vip.session EXECUTE FUNCTION vip.bury()",
      "CREATE INDEX ON vip.session (sender)",
      "COPY vip.session TO PROGRAM 'cat'",
      "SET ROLE lab_theirs; SELECT person FROM vip.session",
      "SET ROLE lab_owner; SELECT person FROM vip.session",
      "SET ROLE lab_lab_reader; SELECT person FROM lab.session",
      "SET SESSION AUTHORIZATION lab_theirs; SELECT person FROM vip.session",
      "SET ROLE lab_station; DELETE FROM vip.session WHERE session_uid = " + uid,
      "GRANT lab_lab_reader TO lab_mine",
      "INSERT INTO vip.tombstone (person, participant, code, station, withdrawn_utc, sender) VALUES "
      "('p', 'p', 'p', 's', 'u', 'lab_theirs')",
      "INSERT INTO vip.note (session_uid, note_id, utc, words, sender) VALUES (" + uid +
          ", 7, 'u', 'w', 'lab_theirs')",
      "INSERT INTO vip.note (session_uid, note_id, utc, words) VALUES (" + uid + ", 7, 'u', 'w')",
      "INSERT INTO vip.part (of, part, sha256, rows, sender) VALUES (" + uid +
          ", 'core', repeat('0', 64), 1, 'lab_theirs') ON CONFLICT (of, sender, part) DO UPDATE SET rows = 0",
      "DELETE FROM vip.tombstone",
      "DELETE FROM vip.protocol",
      "DELETE FROM vip.run",
      "UPDATE vip.schema_version SET number = 1",
      "SELECT * FROM vip.chosen",
      "SELECT * FROM vip.permission",
      "SELECT vip.wait_for_person('p')",
      "SELECT vip.drop_refused_gaze(" + uid + ")",
      "SELECT * FROM vip.withdrawn_among(ARRAY(SELECT person FROM vip.session))",
      "CREATE TABLE public.t (n int)",
      "CREATE TEMP TABLE t (n int)",
      "CREATE SCHEMA s",
      "CREATE FUNCTION public.f() "
      "RETURNS int LANGUAGE sql AS 'SELECT 1'",
      "CREATE FUNCTION pg_temp.f() RETURNS int LANGUAGE sql AS 'SELECT 1'",
      "DO $$ BEGIN EXECUTE 'TRUNCATE vip.session CASCADE'; END $$",
      "SELECT most_common_vals::text FROM pg_stats WHERE schemaname = 'vip'",
      "SELECT pg_read_file('PG_VERSION')",
      "SELECT query FROM pg_stat_activity WHERE usename <> session_user",
      "COPY (SELECT person FROM vip.session) TO STDOUT",
      "ALTER ROLE lab_mine CREATEROLE"};
  attacks.insert(attacks.end(), others.begin(), others.end());
  const std::vector<std::string> marks{of_theirs("session_uid"), of_theirs("person"), "lab_theirs"};
  std::set<std::string> harmless;
  const auto rights = [] {
    return test::lab().ask(
        "SELECT relacl::text FROM pg_class WHERE relnamespace = 'vip'::regnamespace ORDER BY oid");
  };
  const auto rights_before = rights();
  auto connection = std::make_unique<pg::Connection>("lab_mine");
  for (const std::string& attack : attacks) {
    pg::Connection& station = *connection;
    // Only the last statement's rows are seen, as psql would show them.
    const auto last = attack.rfind("; ");
    try {
      if (last != std::string::npos) station.script(attack.substr(0, last));
      if (attack.starts_with("COPY (")) {
        station.copy_out(attack, [&](const pg::Row& row) { EXPECT_NE(row.at(0), marks[1]); });
        continue;
      }
      const auto rows = station.run(last == std::string::npos ? attack : attack.substr(last + 2));
      harmless.insert(attack.substr(0, attack.find(' ')));
      for (int i = 0; i < rows.size(); ++i) {
        for (const std::string& mark : marks)
          EXPECT_EQ(rows.at(i, 0).value_or("").find(mark), std::string::npos) << attack;
      }
      EXPECT_TRUE(!attack.starts_with("TRUNCATE") && !attack.starts_with("UPDATE") &&
                  !attack.starts_with("INSERT"))
          << "was accepted: " << attack;
    } catch (const pg::Failure& failure) {
      EXPECT_FALSE(failure.lost()) << attack;
    }
    // What changed the settings of the session must not help the next attack fail.
    if (last != std::string::npos || attack.starts_with("COPY"))
      connection = std::make_unique<pg::Connection>("lab_mine");
  }
  // GRANT of a right that the role has not is a warning.
  EXPECT_THAT(harmless, ::testing::IsSubsetOf({"SELECT", "DELETE", "SET", "COPY", "GRANT"}));
  EXPECT_EQ(rights(), rights_before);
  EXPECT_EQ(test::lab().rows_of("lab_theirs"), before);
  push(*folder_ / "mine.db", "lab_mine");  // puts back what the station did to its own rows
}

TEST_F(CentralRoles, AMalformedRowIsRefusedWithItsWholeTransaction) {
  const std::string station = test::lab().admit("sloppy");
  const std::string uid = "00000000000000000000000000000001";
  const std::string run =
      "INSERT INTO vip.run (run_uid, started_utc, program_version, options) VALUES ('r', 'u', 'v', '{}')";
  const std::string protocol =
      "INSERT INTO vip.protocol (protocol_sha256, name, version, text, test_data) VALUES (repeat('a', 64), "
      "'n', 'v', 't', 1)";
  const std::string good_session =
      "INSERT INTO vip.session (session_uid, run_uid, protocol_sha256, participant, person, code, visit, "
      "seed, slot, "
      "state, test_data, clock, display, stimulus, machine, station, time_zone, gaze_source) VALUES ('" +
      uid +
      "', 'r', repeat('a', 64), 'P01', 'somebody', 'P01', 1, 1, 0, 'open', 1, 'virtual', 'd', 's', 'm', 's', "
      "'z', 'none')";
  const std::string good_trial =
      "INSERT INTO vip.trial (session_uid, trial_id, position, group_index, first_cell, schedule_seed, "
      "state, set_aside) "
      "VALUES ('" +
      uid + "', 1, 0, 0, 0, 1, 'planned', 0)";
  const auto changed = [](std::string sql, const std::string& what, const std::string& by) {
    const auto at = sql.rfind(what);
    return sql.replace(at, what.size(), by);
  };
  struct Case {
    std::vector<std::string> statements;
    const char* reason;
  };
  const std::vector<Case> cases{
      {{run, protocol, changed(good_session, "'P01', 'somebody'", "'P 01', 'somebody'")}, "check constraint"},
      {{run, protocol, changed(good_session, "'none'", "'eyes'")}, "check constraint"},
      {{run, protocol, changed(good_session, "1, 1, 0, 'open'", "'one', 1, 0, 'open'")},
       "invalid input syntax"},
      {{run, protocol, changed(good_session, "'somebody'", "NULL")}, "null value"},
      {{protocol, good_session}, "foreign key"},
      {{run, good_session}, "foreign key"},
      {{run, changed(protocol, "64", "63"), good_session}, "check constraint"},
      {{run, protocol, good_session, good_trial, good_trial}, "duplicate key"},
      {{run, protocol, good_session, changed(good_trial, uid, of_theirs("session_uid"))}, "foreign key"},
      {{run, protocol, good_session, changed(good_trial, uid, "elsewhere")}, "foreign key"},
      {{run, protocol, changed(good_session, "'somebody'", "E'a\\x00b'")}, "0x00"},
      {{run, protocol, changed(good_session, "'somebody'", "E'a\\xff'")}, "invalid byte sequence"}};
  for (const Case& one : cases) {
    const std::string message = test::message_of([&] {
      pg::Connection centre(station);
      pg::Transaction transaction(centre);
      for (const std::string& sql : one.statements) centre.run(sql);
      transaction.commit();
    });
    EXPECT_THAT(message, HasSubstr(one.reason));
    EXPECT_THAT(test::lab().rows_of(station), IsEmpty()) << one.reason;
  }
  pg::Connection centre(station);
  pg::Transaction transaction(centre);
  for (const std::string& sql : {good_trial, good_session, protocol, run}) centre.run(sql);
  transaction.commit();
  EXPECT_EQ(test::lab().rows_of(station).size(), 4u) << "the sound rows are refused too";
}

/// A session and a withdrawal of its person at the same time, in both orders.
TEST_F(CentralRoles, ASessionAndAWithdrawalThatMeetLeaveNothing) {
  const auto id = [](int i) { return "meet" + std::to_string(i); };
  const std::string station = test::lab().admit("meeting");
  const auto insert = [&](pg::Connection& centre, const std::string& person) {
    centre.run(
        "INSERT INTO vip.run (run_uid, started_utc, program_version, options) VALUES ($1, 'u', 'v', '{}')",
        {person});
    centre.run(
        "INSERT INTO vip.protocol (protocol_sha256, name, version, text, test_data) VALUES (repeat('b', 64), "
        "'n', "
        "'v', 't', 1) ON CONFLICT DO NOTHING");
    centre.run(
        "INSERT INTO vip.session (session_uid, run_uid, protocol_sha256, participant, person, code, visit, "
        "seed, slot, state, "
        "test_data, clock, display, stimulus, machine, station, time_zone, gaze_source) VALUES ($1, $1, "
        "repeat('b', 64), "
        "'P01', $1, 'P01', 1, 1, 0, 'open', 1, 'virtual', 'd', 's', 'm', 's', 'z', 'none')",
        {person});
  };
  const auto bury = [&](pg::Connection& centre, const std::string& person) {
    centre.run(
        "INSERT INTO vip.tombstone (person, participant, code, station, withdrawn_utc) VALUES ($1, $1, $1, "
        "'s', 'u')",
        {person});
  };
  for (const bool session_first : {true, false}) {
    const std::string person = id(session_first ? 1 : 2);
    pg::Connection first(station), second(station);
    pg::Transaction begun(first);
    session_first ? insert(first, person) : bury(first, person);
    std::string message;
    std::thread other([&] {
      message = test::message_of([&] {
        pg::Transaction transaction(second);
        session_first ? bury(second, person) : insert(second, person);
        transaction.commit();
      });
    });
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    const std::string waiting = "SELECT 1 FROM pg_locks WHERE locktype = 'advisory' AND NOT granted";
    while (test::lab().ask(waiting).empty() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_LT(std::chrono::steady_clock::now(), end) << "the second does not wait for the first";
    begun.commit();
    other.join();
    EXPECT_THAT(message, HasSubstr(session_first ? "nothing was thrown" : "withdrew"));
    EXPECT_THAT(test::lab().ask("SELECT count(*) FROM vip.session WHERE person = '" + person + "'"),
                ElementsAre("0"));
  }
  pg::Connection stale(station);
  pg::Transaction transaction(stale, "BEGIN ISOLATION LEVEL REPEATABLE READ");
  EXPECT_THAT(test::message_of([&] { insert(stale, "meet3"); }), HasSubstr("must be READ COMMITTED"));
}

}  // namespace
}  // namespace study
