/// Five stations push at once, while clients are killed, connections cut and the server stopped at random
/// instants: every row arrives once, and a withdrawal wins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <random>
#include <thread>

#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/common/cutting_proxy.hpp"
#include "tests/libstudy/central_fixture.hpp"
#include "tests/libstudy/stored_content.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace apps::test {
namespace {

using study::sqlite::Open;
using study::test::Lab;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int stations = 5;

/// What the storm did, for the output of the test.
struct Counts {
  int kills = 0, terminated = 0, cuts = 0, stops = 0, failed = 0, whole = 0, withdrawals = 0;
};

class Storm {
 public:
  explicit Storm(unsigned seed) : chance_(seed), proxy_(server_.folder() / "s" / socket_name()) {
    ::setenv("OMP_WAIT_POLICY", "passive", 0);  // else each program starts itself a second time
    for (int i = 0; i < stations; ++i) {
      files_.push_back(folder_ / ("s" + std::to_string(i) + ".db"));
      roles_.push_back(lab_.admit("s" + std::to_string(i)));
      // Stations 2, 3 and 4 push over a network that can be cut.
      services_.push_back(roles_.back() + (i > 1 ? "_cut" : ""));
      if (i > 1)
        server_.add_service(services_.back(), roles_.back(), lab_.service(),
                            "host=127.0.0.1\nport=" + std::to_string(proxy_.port()));
      add_people(i, 2);
    }
    // Two stations hold sessions of the same people.
    fs::copy_file(files_[0], folder_ / "copy.db");
    study::merge({folder_ / "copy.db"}, files_[1]);
  }

  void round() {
    for (int i = 0; i < stations; ++i) live(i);
    if (++rounds_ == 2) withdraw_somebody(files_[0]);
    std::vector<std::unique_ptr<Process>> pushes;
    for (int i = 0; i < stations; ++i) {
      if (old_.contains(i) && one_in(3)) pushes.push_back(start_push(old_.at(i), services_[index(i)]));
      pushes.push_back(start_push(files_[index(i)], services_[index(i)]));
    }
    const auto start = std::chrono::steady_clock::now();
    if (!one_in(4)) wait_for_a_push();
    for (int blow = 0; blow < 4; ++blow) {
      std::this_thread::sleep_for(std::chrono::microseconds(pick(pause_us_)));
      strike(pushes);
    }
    for (const auto& push : pushes) {
      const Ended ended = push->wait();
      ended.exit_code == 0 ? ++counts.whole : ++counts.failed;
      if (ended.signal == SIGKILL || ended.exit_code == 0) continue;
      EXPECT_EQ(ended.exit_code, 1) << ended.signal;
      EXPECT_THAT(ended.err, HasSubstr("error: service "));
      EXPECT_THAT(ended.err, HasSubstr("mend: "));
    }
    // The blows fall into the time that pushes take on this machine now.
    const auto took = std::chrono::steady_clock::now() - start;
    pause_us_ = std::clamp(static_cast<int>(took / std::chrono::microseconds(3)), 20'000, 1'000'000);
  }

  /// Pushes everything in peace, and compares each station's rows at the centre with its file.
  void check() {
    for (int i = 0; i < stations; ++i) push_in_peace(i);
    for (int i = 0; i < stations; ++i) {  // withdrawals that a later station brought
      const auto codes = study::withdrawn_at_centre(files_[index(i)], roles_[index(i)]);
      for (const std::string& code : codes) study::withdraw(files_[index(i)], code);
      if (!codes.empty()) push_in_peace(i);
    }
    for (int i = 0; i < stations; ++i) {
      const auto there = of_people(lab_.rows_of(roles_[index(i)]));
      const auto here = of_people(Lab::rows_of_file(files_[index(i)]));
      std::vector<std::string> wrong;
      std::set_symmetric_difference(there.begin(), there.end(), here.begin(), here.end(),
                                    std::back_inserter(wrong));
      EXPECT_THAT(wrong, IsEmpty()) << "station " << i;
      EXPECT_FALSE(there.empty());
    }
    EXPECT_EQ(study::push(files_[0], roles_[0]).rows, 0) << "a second push sends rows";
    for (const std::string& person : withdrawn_)
      EXPECT_THAT(lab_.ask("SELECT session_uid FROM vip.session WHERE person = '" + person + "'"), IsEmpty());
  }

  /// What readers see is what the merged files hold: sessions, answers and frames.
  void check_union() {
    const fs::path all = folder_ / "all.db";
    std::vector<fs::path> sources(files_.begin(), files_.end());
    study::merge(sources, all);
    const auto lines = study::test::select(
        all,
        "SELECT s.uid || ' ' || s.person || ' ' || s.state || ' ' || (SELECT count(*) || ' ' || sum(r.score) "
        "FROM response r "
        "JOIN unit u USING (unit_id) WHERE u.session_id = s.session_id) || ' ' || (SELECT count(*) || ' ' || "
        "sum(f.scheduled_ns) FROM frame f JOIN presentation USING (presentation_id) JOIN trial t USING "
        "(trial_id) WHERE "
        "t.session_id = s.session_id) FROM session s ORDER BY s.uid");
    EXPECT_GT(lines.size(), 0u);
    EXPECT_EQ(
        lab_.ask(
            "SELECT s.session_uid || ' ' || s.person || ' ' || s.state || ' ' || (SELECT count(*) || ' ' || "
            "sum(r.score) FROM lab.response r WHERE r.session_uid = s.session_uid) || ' ' || (SELECT "
            "count(*) || "
            "' ' || sum(f.scheduled_ns) FROM lab.frame f WHERE f.session_uid = s.session_uid) FROM "
            "lab.session s "
            "ORDER BY s.session_uid COLLATE \"C\""),
        lines);
  }

  /// The report of the central database is that of the merged files (check_union() made them), but for the
  /// name of the database and the time of the report.
  void check_report() {
    const std::string reader = lab_.admit("anna", study::central::Admission::LabReader);
    std::vector<std::string> reports;
    for (const std::string& database : {(folder_ / "all.db").string(), "service:" + reader}) {
      const std::string file = folder_ / "report.json";
      fs::remove(file);
      const Ended ended = run_program({VIP_BIN_DIR "/vip-stats", "report", database, "--json", file});
      EXPECT_EQ(ended.exit_code, 0) << ended.err;
      std::string text = base::read_file(file, 1 << 26);
      const auto time = base::Json::parse(text).at("date_utc").get<std::string>();
      for (const std::string& part : {fs::path(database).filename().string(), time})
        for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at))
          text.erase(at, part.size());
      reports.push_back(std::move(text));
    }
    EXPECT_GT(reports[0].size(), 1000u);
    EXPECT_TRUE(reports[0] == reports[1]) << "the reports differ";
  }

  Counts counts;

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  std::string socket_name() const { return ".s.PGSQL." + std::to_string(server_.port()); }
  int pick(int below) { return std::uniform_int_distribution<int>(0, below - 1)(chance_); }
  bool one_in(int number) { return pick(number) == 0; }

  static std::unique_ptr<Process> start_push(const fs::path& file, const std::string& service) {
    return std::make_unique<Process>(
        std::vector<std::string>{vip_study, "push", "--db", file, "--to", service});
  }

  void add_people(int station, int count) {
    study::Store store(files_[index(station)], Open::Create);
    std::vector<std::string> codes;
    for (int i = 0; i < count; ++i) codes.push_back("P" + std::to_string(++people_));
    study::RunPlan run = study::test::run_plan(study::test::pairs(), codes);
    for (study::SessionPlan& session : run.sessions) session.station = "s" + std::to_string(station);
    store.add_run(run);
  }

  /// A station records on; now and then somebody comes, or withdraws, or the file is copied.
  void live(int station) {
    const fs::path& file = files_[index(station)];
    if (one_in(5)) {
      old_[station] = folder_ / ("old" + std::to_string(station) + ".db");
      fs::copy_file(file, old_.at(station), fs::copy_options::overwrite_existing);
      fs::copy_file(file.string() + ".answers.jsonl", old_.at(station).string() + ".answers.jsonl",
                    fs::copy_options::overwrite_existing);
    }
    if (one_in(12)) withdraw_somebody(file);
    if (station == 1 && one_in(15)) merge_from(0, file);
    std::size_t open = 0;
    {
      study::Store store(file, Open::Write);
      for (const study::OpenRun& run : store.open_runs()) {
        for (const study::OpenSession& session : run.sessions) {
          // What came from another station's file stays as it is, or the two copies would go apart.
          if (session.plan.station != "s" + std::to_string(station)) continue;
          ++open;
          if (one_in(2)) go_on(store, session);
        }
      }
    }
    if (open < 2 && one_in(2)) add_people(station, 1);
  }

  /// Takes in what another station has: all row numbers of the file change.
  void merge_from(int other, const fs::path& file) {
    const fs::path copy = folder_ / "copy.db";
    fs::copy_file(files_[index(other)], copy, fs::copy_options::overwrite_existing);
    fs::remove(copy.string() + ".answers.jsonl");
    study::merge({copy}, file);
  }

  static void go_on(study::Store& store, const study::OpenSession& session) {
    const study::OpenUnit& unit = session.units.front();
    if (!unit.trial)
      store.finish_unit(session.id, unit.id, 900);
    else
      study::test::answer_one(store, session, unit, "ease",
                              study::test::score(static_cast<int>(1 + unit.id % 7)));
  }

  void withdraw_somebody(const fs::path& file) {
    const auto here =
        study::test::select(file, "SELECT participant || ' ' || person FROM session ORDER BY session_id");
    if (here.size() < 2) return;
    const std::string& who = here[index(pick(static_cast<int>(here.size())))];
    study::withdraw(file, who.substr(0, who.find(' ')));
    withdrawn_.insert(who.substr(who.find(' ') + 1));
    ++counts.withdrawals;
  }

  /// Waits until a push is connected, so that not all blows fall into the starts of programs.
  void wait_for_a_push() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (std::chrono::steady_clock::now() < end && sessions("SELECT 1").empty())
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }

  /// A query of the server's sessions of stations.
  std::vector<std::string> sessions(const std::string& select) {
    return lab_.ask(select + " FROM pg_stat_activity WHERE usename LIKE '" + lab_.service() +
                    "\\_s_' ORDER BY random() LIMIT 2");
  }

  /// One blow: a client, sessions of the server, the network, or the server itself, in turn.
  void strike(const std::vector<std::unique_ptr<Process>>& pushes) {
    enum Blow { Client, Session, Network, Server };
    constexpr std::array turns{Client, Network, Session, Server, Client, Session, Network, Client};
    switch (turns[blows_++ % turns.size()]) {
      case Client:
        pushes[index(pick(static_cast<int>(pushes.size())))]->send(SIGKILL);
        ++counts.kills;
        break;
      case Session:
        counts.terminated += static_cast<int>(sessions("SELECT pg_terminate_backend(pid)").size());
        break;
      case Network:
        proxy_.cut();
        break;
      case Server:
        server_.stop_immediately();
        server_.start();
        ++counts.stops;
    }
  }

  void push_in_peace(int station) {
    const study::Push done = study::push(files_[index(station)], roles_[index(station)]);
    EXPECT_THAT(done.refused, IsEmpty());
  }

  /// Rows without protocols and runs, which stay when their last session is withdrawn. A tombstone counts by
  /// its person: a merge may give it the code and the time of another station, the centre keeps the first.
  static std::vector<std::string> of_people(std::vector<std::string> lines) {
    std::erase_if(lines, [](const std::string& line) {
      const auto scope = study::central::table(line.substr(0, line.find('\t'))).scope;
      return scope == study::central::Scope::Protocol || scope == study::central::Scope::Run;
    });
    for (std::string& line : lines)
      if (line.starts_with("tombstone\t")) line.resize(line.find('\t', 10));
    std::sort(lines.begin(), lines.end());
    return lines;
  }

 public:
  int cuts() const { return proxy_.cuts(); }

 private:
  std::mt19937 chance_;
  PostgresServer& server_ = postgres_server();
  Lab lab_{"storm"};
  CuttingProxy proxy_;
  TemporaryFolder folder_;
  std::vector<fs::path> files_;
  std::vector<std::string> roles_, services_;
  std::map<int, fs::path> old_;  // an older copy of a station's file
  std::set<std::string> withdrawn_;
  int people_ = 0, rounds_ = 0;
  std::size_t blows_ = 0;
  int pause_us_ = 400'000;  // longest wait before a blow
};

Counts storm(unsigned seed, int rounds, bool each) {
  Storm storm(seed);
  for (int round = 0; round < rounds && !::testing::Test::HasFailure(); ++round) {
    storm.round();
    if (each || round + 1 == rounds) storm.check();
    if (round % 20 == 19 || round + 1 == rounds) storm.check_union();
    if (each && round + 1 == rounds) storm.check_report();
  }
  Counts done = storm.counts;
  done.cuts = storm.cuts();
  std::printf(
      "%d rounds: %d pushes ended well, %d did not; %d kills, %d sessions ended, %d connections cut, %d "
      "stops of "
      "the server, %d withdrawals\n",
      rounds, done.whole, done.failed, done.kills, done.terminated, done.cuts, done.stops, done.withdrawals);
  return done;
}

TEST(CentralStormE2e, EveryRowArrivesOnceAndAWithdrawalWins) { storm(1, 2, false); }

TEST(CentralStormSlow, TwoHundredRoundsOfKillsAndCuts) {
  const Counts done = storm(20261130, 200, true);
  for (const int count : {done.kills, done.terminated, done.cuts, done.stops, done.withdrawals})
    EXPECT_GT(count, 20);
}

}  // namespace
}  // namespace apps::test
