/// The programs read a central database as they read the merged file, and vip-study run takes slots from it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "stats/base/json.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/libstudy/central_fixture.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string vip_stats = VIP_BIN_DIR "/vip-stats";

class CentralPrograms : public ::testing::Test {
 protected:
  CentralPrograms() : lab_(next_name()) {
    base::write_file_atomically(protocol_,
                                replaced(short_protocol("0.3"), "participants = 16", "participants = 4"));
  }

  static std::string next_name() {
    static int made = 0;
    return "programs" + std::to_string(++made);
  }
  Ended record(const std::string& station, const std::vector<std::string>& more) {
    auto arguments = run_arguments(protocol_, file(station), {"--station", station, "--display", "none"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  /// Two stations record with slots of the central database, and push; their files are merged, too.
  void record_and_merge(int people) {
    for (const std::string station : {"north", "south"}) {
      const std::string service = station == "north" ? north_ : lab_.admit(station);
      std::vector<std::string> codes{"--slots-from", service, "--participant", "P01"};
      for (int i = 1; i < people; ++i) {
        codes.emplace_back("--participant");
        codes.push_back("Q" + std::to_string(i) + station);
      }
      const auto ended = record(station, codes);
      ASSERT_EQ(ended.exit_code, 0) << ended.err;
      study::push(file(station), service);
    }
    ASSERT_EQ(
        run_program({vip_study, "merge", file("north"), file("south"), "--into", file("merged")}).exit_code,
        0);
    // expect_same() leaves out the second of a report. No session may have ended in that second.
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  }
  /// Expects equal files of both databases, but for the name of the database and the time of the report.
  void expect_same(const std::string& suffix) const {
    const auto text_of = [&](const std::string& name, const std::string& database) {
      const std::string made = name + ".json";
      return without(without(bytes(name + suffix), database),
                     base::Json::parse(bytes(made)).at("date_utc").get<std::string>());
    };
    const std::string merged = text_of("merged", "merged.db"), central = text_of("central", central_);
    EXPECT_EQ(central.size(), merged.size()) << suffix;
    EXPECT_TRUE(central == merged) << suffix;
  }
  std::string file(const std::string& station) const { return folder_ / (station + ".db"); }
  std::string bytes(const std::string& name) const { return base::read_file(folder_ / name, 1 << 26); }
  static std::string without(std::string text, const std::string& part) {
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at))
      text.erase(at, part.size());
    return text;
  }

  const TemporaryFolder folder_;
  const std::string protocol_ = folder_ / "short.toml";
  study::test::Lab lab_;
  const std::string north_ = lab_.admit("north"),
                    central_ = "service:" + lab_.admit("anna", study::central::Admission::LabReader);
};

using CentralReadingE2e = CentralPrograms;
using CentralProgramsSlow = CentralPrograms;

TEST_F(CentralReadingE2e, AReportEqualsThatOfTheMergedFiles) {
  record_and_merge(1);
  for (const auto& [name, database] : {std::pair{"merged", file("merged")}, {"central", central_}}) {
    const std::string out = folder_ / name;
    const auto report =
        run_program({vip_stats, "report", database, "--json", out + ".json", "--html", out + ".html"});
    ASSERT_EQ(report.exit_code, 0) << report.err;
  }
  expect_same(".json");
  expect_same(".html");
  EXPECT_THAT(bytes("merged.html"), HasSubstr("Timing by station"));
  EXPECT_EQ(lab_.ask("SELECT string_agg(slot::text, ' ' ORDER BY slot) FROM vip.slot_session").front(), "0 0")
      << "the pilot has one slot";
}

TEST_F(CentralProgramsSlow, ExportsEqualThoseOfTheMergedFilesAndGoWithWhoWithdraws) {
  record_and_merge(2);
  for (const auto& [name, database] : {std::pair{"merged", file("merged")}, {"central", central_}}) {
    const std::string out = folder_ / name;
    const auto report =
        run_program({vip_stats, "report", database, "--json", out + ".json", "--csv", out + "_csv"});
    ASSERT_EQ(report.exit_code, 0) << report.err;
    const auto status = run_program({vip_study, "status", "--db", database});
    ASSERT_EQ(status.exit_code, 0) << status.err;
    base::write_file_atomically(out + "_status", status.out);
    const auto exported = run_program(
        {vip_study, "export", "--db", database, "--csv", out + "_tables", "--psych-ds", out + "_psych"});
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
  }
  for (const char* suffix : {".json", "_status", "_csv/timing_stations.csv", "_tables/responses.csv",
                             "_tables/sessions.csv", "_tables/frames.csv"})
    expect_same(suffix);

  // A person withdraws at a station: the next command that reads the service deletes what holds the person.
  ASSERT_EQ(run_program({vip_study, "withdraw", "P01", "--db", file("north"), "--yes"}).exit_code, 0);
  study::push(file("north"), north_);
  const auto after = run_program({vip_study, "status", "--db", central_});
  EXPECT_EQ(after.exit_code, 0) << after.err;
  EXPECT_THAT(after.err, HasSubstr("central.json: a person in it withdrew"));
  for (const char* name : {"central.json", "central_csv", "central_tables", "central_psych"})
    EXPECT_FALSE(fs::exists(folder_ / name)) << name;
  EXPECT_TRUE(fs::exists(folder_ / "merged.json"));
  const auto copied = run_program({vip_study, "merge", central_, "--into", file("copied")});
  EXPECT_EQ(copied.exit_code, 0) << copied.err;
  EXPECT_EQ(count_in(file("copied"), "SELECT count(*) FROM session"), 3);
}

TEST_F(CentralProgramsSlow, CommandsThatWriteRefuseAService) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{vip_study, "run", protocol_, "--observer", "random", "--db", central_},
        {vip_study, "resume", "--db", central_},
        {vip_study, "withdraw", "P01", "--db", central_, "--yes"},
        {vip_study, "consent", "P01", "--db", central_, "--gaze", "no"},
        {vip_study, "merge", file("north"), "--into", central_},
        {vip_study, "salvage", "--db", central_, "--into", file("all")}}) {
    const auto ended = run_program(arguments);
    EXPECT_EQ(ended.exit_code, 1) << arguments[1] << ended.out;
    EXPECT_THAT(ended.err, AllOf(HasSubstr(central_), HasSubstr("mend: "))) << arguments[1];
  }
  EXPECT_FALSE(fs::exists(file("all")));
}

TEST_F(CentralProgramsSlow, SlotsComeFromTheServerAndOfflineFromTheBlock) {
  const std::string service = lab_.admit("west"), database = file("west");
  const auto reserved = run_program(
      {vip_study, "slots", "reserve", "2", "--protocol", protocol_, "--db", database, "--from", service});
  ASSERT_EQ(reserved.exit_code, 0) << reserved.err;
  const auto online = record("west", {"--participant", "P01", "--slots-from", service});
  ASSERT_EQ(online.exit_code, 0) << online.err;
  EXPECT_EQ(online.err, "");
  ::test::postgres_server().stop_immediately();
  const auto offline = record("west", {"--participant", "P02", "--slots-from", service});
  EXPECT_EQ(offline.exit_code, 0) << offline.err;
  EXPECT_THAT(offline.err, HasSubstr("slots that were reserved in advance are used"));
  const auto too_many =
      record("west", {"--participant", "P03", "--participant", "P04", "--slots-from", service});
  EXPECT_EQ(too_many.exit_code, 1);
  EXPECT_THAT(too_many.err, HasSubstr("1 are left for 2 sessions"));
  ::test::postgres_server().start();
  const auto list = run_program({vip_study, "slots", "list", "--db", database});
  EXPECT_THAT(list.out,
              AllOf(HasSubstr("has P01"), HasSubstr("has P02"), HasSubstr("free, reserved in advance")));
  const auto back = run_program({vip_study, "slots", "return", "--db", database, "--from", service});
  EXPECT_EQ(back.exit_code, 0) << back.err;
  EXPECT_THAT(run_program({vip_study, "slots", "list", "--db", database}).out, HasSubstr("returned"));
  EXPECT_EQ(lab_.ask("SELECT count(*) FROM vip.open_reservation").front(), "2")
      << "those of P01 and P02, not pushed yet";
  const auto pushed = run_program({vip_study, "push", "--db", database, "--to", service});
  EXPECT_EQ(pushed.exit_code, 0) << pushed.err;
  EXPECT_EQ(lab_.ask("SELECT count(*) FROM vip.open_reservation").front(), "0");
  EXPECT_THAT(record("east", {"--participant", "P05", "--slots-from", "host=x"}).err,
              HasSubstr("is not a name"));
}

TEST(CentralWithoutLibpqE2e, OnlyTheCentralDatabaseIsMissing) {
  const TemporaryFolder folder;
  base::write_file_atomically(folder / "libpq.so.5", "no library");
  const auto run = [&](const std::vector<std::string>& arguments) {
    return run_program(arguments, [&] { ::setenv("LD_LIBRARY_PATH", folder.path().c_str(), 1); });
  };
  const Ended version = run({vip_study, "--version"});
  EXPECT_EQ(version.exit_code, 0) << version.err;
  const Ended central = run({vip_study, "status", "--db", "service:lab"});
  EXPECT_EQ(central.exit_code, 1);
  EXPECT_THAT(central.err, AllOf(HasSubstr("libpq.so.5"), HasSubstr("mend: install libpq5")));
}

}  // namespace
}  // namespace apps::test
