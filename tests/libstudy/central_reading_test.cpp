/// Reading a study from a central database: it equals that of the merged files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/file/schema.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/remote/central_study.hpp"
#include "libstudy/store/withdraw.hpp"
#include "tests/libstudy/central_world.hpp"
#include "tests/libstudy/stored_content.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

/// Every row of the tables that leave a station, without events of no session.
std::string all_rows(Connection& database) {
  std::string out;
  for (const central::Table& table : central::tables()) {
    std::string list;
    for (const std::string& column : columns_of(table.name))
      list += (list.empty() ? "\"" : ", \"") + column + "\"";
    out += "== " + table.name + "\n";
    Statement row(database, "SELECT " + list + " FROM \"" + table.name + "\"" +
                                (table.name == "event" ? " WHERE session_id IS NOT NULL" : "") +
                                " ORDER BY 1, 2");
    while (row.step()) {
      for (int i = 0; i < row.columns(); ++i)
        out += (row.is_null(i) ? "NULL" : row.is_real(i) ? pg::text_of(row.real(i)) : row.text(i)) + "|";
      out += "\n";
    }
  }
  return out;
}

void record(const fs::path& path, const std::string& station, const std::vector<std::string>& people,
            int trials) {
  RunPlan run = test::run_plan(test::pilot(), people);
  for (SessionPlan& session : run.sessions) session.station = station;
  Store store(path, Open::Create);
  store.add_run(run);
  for (const OpenRun& open : store.open_runs())
    for (const OpenSession& session : open.sessions) {
      int left = trials;
      for (const OpenUnit& unit : session.units)
        if (unit.trial && left-- > 0)
          test::answer_one(store, session, unit, "satisfaction", test::score(1 + left % 7));
      store.note(session.id, {}, station + " 'quoted', \\N\tand\n\"more\"");
    }
}

/// Three stations with sessions under way, codes that two of them gave, and somebody who withdrew.
struct Recorded {
  explicit Recorded(const std::string& name) : world(name) {
    record(folder / "north.db", "north", {"P01", "P02"}, 2);
    record(folder / "south.db", "south", {"P02", "P03", "P04"}, 1);
    record(folder / "east.db", "east", {"P05"}, 3);
    withdraw(folder / "south.db", "P04");
    for (const char* station : {"north", "south", "east"}) services.push_back(world.station(station));
  }
  fs::path file(std::size_t i) const {
    return folder / (std::vector<std::string>{"north.db", "south.db", "east.db"}.at(i));
  }
  std::string merged() {
    const fs::path into = folder / "merged.db";
    merge({file(0), file(1), file(2)}, into);
    Connection database(into, Open::Read);
    return all_rows(database);
  }
  test::TemporaryFolder folder;
  test::CentralWorld world;
  std::vector<std::string> services;
};

TEST(CentralReading, EqualsTheMergedFilesInAnyOrderOfPushes) {
  for (const std::vector<std::size_t>& order : {std::vector<std::size_t>{0, 1, 2}, {2, 1, 0}}) {
    Recorded study("reading_" + std::to_string(order.front()));
    for (const std::size_t i : order) test::send_all(study.services[i], study.file(i));
    const auto read = read_central_study(study.world.reader("anna"));
    EXPECT_EQ(all_rows(*read), study.merged());
  }
}

TEST(CentralReading, TheSharedViewsHoldThoseWhoShare) {
  test::CentralWorld world("reading_shared");
  const test::TemporaryFolder folder;
  const fs::path fixture = base::resource("tests/libstudy/fixtures/study_v8.db"), path = folder / "s.db";
  fs::copy_file(fixture, path);
  change_permissions(path, "P01", {.gaze = {}, .sharing = false});
  test::send_all(world.station("north"), path);
  const auto lab = read_central_study(world.reader("anna"));
  const auto shared = read_central_study(world.shared_reader("ben"));
  EXPECT_EQ(lab->integer("SELECT count(*) FROM session WHERE participant = 'P01'"), 1);
  EXPECT_EQ(shared->integer("SELECT count(*) FROM session WHERE participant = 'P01'"), 0);
  EXPECT_EQ(shared->integer("SELECT count(*) FROM sharing WHERE granted = 0"), 0);
  EXPECT_EQ(lab->integer("SELECT count(*) FROM session"),
            1 + shared->integer("SELECT count(*) FROM session"));
}

TEST(CentralReading, ReadersOpenAServiceAndWritersRefuseIt) {
  Recorded study("reading_opened");
  const std::string anna = study.world.reader("anna");
  test::send_all(study.services[0], study.file(0));
  read_central_with(read_central_study);
  const TaskStudy tasks = read_tasks("service:" + anna);
  ASSERT_EQ(tasks.protocols.size(), 1u);
  EXPECT_EQ(tasks.protocols.front().sessions.size(), 2u);
  const auto refused = ThrowsMessage<base::Error>(HasSubstr("is a central database"));
  EXPECT_THAT([&] { Store("service:" + anna, Open::Create); }, refused);
  EXPECT_THAT([&] { withdraw("service:" + anna, "P01"); }, refused);
  EXPECT_THAT([&] { merge({study.file(0)}, "service:" + anna); }, refused);
  EXPECT_FALSE(fs::exists("service:" + anna));
}

TEST(CentralReading, AStationIsNoReaderAndAnotherSchemaIsNamed) {
  Recorded study("reading_rights");
  EXPECT_THAT([&] { read_central_study(study.services[0]); },
              ThrowsMessage<base::Error>(HasSubstr("may read neither")));
  study.world.sql("UPDATE vip.schema_version SET number = number - 1");
  EXPECT_THAT([&] { read_central_study(study.world.reader("anna")); },
              ThrowsMessage<base::Error>(HasSubstr("vip-study central upgrade")));
}

}  // namespace
}  // namespace study
