/// The programs read a central database as they read the merged file, and vip-study run takes slots from it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/json.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/libstudy/central_world.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string vip_stats = VIP_BIN_DIR "/vip-stats";

/// Text without the time at which it was made, and with the same name for both databases.
std::string without_place(std::string text, const std::string& database) {
  const auto replace_all = [&](const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
      text.replace(at, what.size(), by);
  };
  replace_all(database, "DATABASE");
  for (std::size_t at = text.find("\"date_utc\": \""); at != std::string::npos; at = std::string::npos) {
    const std::string date = text.substr(at + 13, 20);
    replace_all(date, "DATE");
  }
  return text;
}

class CentralReadingE2e : public ::testing::Test {
 protected:
  CentralReadingE2e() : world_("reading_programs"), anna_(world_.reader("anna")) {
    base::write_file_atomically(protocol_,
                                replaced(short_protocol("0.3"), "participants = 16", "participants = 4"));
  }

  Ended record(const std::string& station, const std::vector<std::string>& more) {
    auto arguments = run_arguments(protocol_, file(station), {"--station", station, "--display", "none"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  std::string file(const std::string& station) const { return folder_ / (station + ".db"); }
  std::string bytes(const std::string& name) const { return base::read_file(folder_ / name, 1 << 26); }

  const TemporaryFolder folder_;
  const std::string protocol_ = folder_ / "short.toml";
  study::test::CentralWorld world_;
  const std::string anna_;
};

TEST_F(CentralReadingE2e, ReportsAndExportsEqualThoseOfTheMergedFiles) {
  std::vector<std::string> files;
  for (const char* station : {"north", "south"}) {
    std::vector<std::string> people{"--participant", "P01"};
    people.emplace_back("--participant");
    people.push_back(std::string("Q-") + station);
    const auto ended = record(station, people);
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    study::test::send_all(world_.station(station), file(station));
    files.push_back(file(station));
  }
  const std::string merged = file("merged"), central = "service:" + anna_;
  ASSERT_EQ(run_program({vip_study, "merge", files[0], files[1], "--into", merged}).exit_code, 0);
  for (const auto& [name, database] : {std::pair{"merged", merged}, {"central", central}}) {
    const std::string out = folder_ / name;
    const auto report = run_program({vip_stats, "report", database, "--json", out + ".json", "--html",
                                     out + ".html", "--csv", out + "_csv"});
    ASSERT_EQ(report.exit_code, 0) << report.err;
    const auto status = run_program({vip_study, "status", "--db", database});
    ASSERT_EQ(status.exit_code, 0) << status.err;
    base::write_file_atomically(out + "_status", status.out);
    const auto exported = run_program(
        {vip_study, "export", "--db", database, "--csv", out + "_tables", "--psych-ds", out + "_psych"});
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
  }
  const std::string shown = "service:" + anna_;
  const auto same = [&](const std::string& suffix) {
    const std::string date_m = without_place(bytes("merged" + suffix), "merged.db");
    const std::string date_c = without_place(bytes("central" + suffix), shown);
    EXPECT_EQ(date_c.size(), date_m.size()) << suffix;
    EXPECT_TRUE(date_c == date_m) << suffix;
  };
  for (const char* suffix : {".json", "_status", "_csv/timing_stations.csv", "_tables/responses.csv",
                             "_tables/sessions.csv", "_tables/frames.csv"})
    same(suffix);
  const auto page = [&](const std::string& name, const std::string& database) {
    std::string text = without_place(bytes(name + ".html"), database);
    const std::string date = base::Json::parse(bytes(name + ".json")).at("date_utc").get<std::string>();
    for (std::size_t at = text.find(date); at != std::string::npos; at = text.find(date))
      text.erase(at, date.size());
    return text;
  };
  EXPECT_TRUE(page("central", shown) == page("merged", "merged.db"));
  EXPECT_THAT(bytes("merged.html"), HasSubstr("Timing by station"));
}

TEST_F(CentralReadingE2e, CommandsThatWriteRefuseAService) {
  const std::string central = "service:" + anna_;
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{vip_study, "run", protocol_, "--observer", "random", "--db", central},
        {vip_study, "resume", "--db", central},
        {vip_study, "withdraw", "P01", "--db", central, "--yes"},
        {vip_study, "consent", "P01", "--db", central, "--gaze", "no"},
        {vip_study, "merge", file("north"), "--into", central},
        {vip_study, "salvage", "--db", central, "--into", file("all")}}) {
    const auto ended = run_program(arguments);
    EXPECT_EQ(ended.exit_code, 1) << arguments[1] << ended.out;
    EXPECT_THAT(ended.err, AllOf(HasSubstr(central), HasSubstr("mend: "))) << arguments[1];
  }
  EXPECT_FALSE(fs::exists(file("all")));
}

TEST_F(CentralReadingE2e, SlotsComeFromTheServerAndOfflineFromTheBlock) {
  const std::string service = world_.station("west"), database = file("west");
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
  EXPECT_EQ(world_.sql("SELECT count(*) FROM vip.open_reservation"), "2")
      << "those of P01 and P02, not pushed yet";
  study::test::send_all(service, database);
  EXPECT_EQ(world_.sql("SELECT count(*) FROM vip.open_reservation"), "0");
  EXPECT_THAT(record("east", {"--participant", "P05", "--slots-from", "host=x"}).err,
              HasSubstr("is not a name"));
}

}  // namespace
}  // namespace apps::test
