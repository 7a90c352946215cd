/// Reading a study from a central database: it equals that of the merged files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "libstudy/store/file/schema.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/remote/central_study.hpp"
#include "libstudy/store/withdraw.hpp"
#include "tests/libstudy/central_fixture.hpp"
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

/// Three stations with sessions under way, codes that several of them gave, somebody who withdrew, and
/// somebody who does not share. Pushes their files in this order.
struct Recorded {
  Recorded(const std::string& name, const std::vector<std::size_t>& order) : lab(name) {
    record(files[0], "north", {"P01", "P02"}, 2);
    record(files[1], "south", {"P02", "P03"}, 1);
    fs::copy_file(base::resource("tests/libstudy/fixtures/study_v8.db"), files[2]);
    withdraw(files[1], "P03");
    change_permissions(files[2], "P01", {.gaze = {}, .sharing = false});
    for (const char* station : {"a", "b", "c"}) services.push_back(lab.admit(station));
    for (const std::size_t i : order) study::push(files.at(i), services.at(i));
    reader = lab.admit("anna", central::Admission::LabReader);
  }
  std::string merged() const {
    const fs::path into = folder / "merged.db";
    merge(files, into);
    Connection database(into, Open::Read);
    return all_rows(database);
  }
  test::TemporaryFolder folder;
  std::vector<fs::path> files{folder / "north.db", folder / "south.db", folder / "east.db"};
  test::Lab lab;
  std::vector<std::string> services;
  std::string reader;
};

Recorded& recorded() {
  static Recorded made("reading", {1, 2, 0});
  return made;
}

TEST(CentralReading, EqualsTheMergedFiles) {
  const auto read = read_central_study(recorded().reader);
  EXPECT_EQ(all_rows(*read), recorded().merged());
}

TEST(CentralReadingSlow, EqualsTheMergedFilesInAnyOrderOfPushes) {
  std::vector<std::size_t> order{0, 1, 2};
  int number = 0;
  do {
    const Recorded study("reading_" + std::to_string(++number), order);
    EXPECT_EQ(all_rows(*read_central_study(study.reader)), study.merged());
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(CentralReading, TheSharedViewsHoldThoseWhoShare) {
  const auto lab = read_central_study(recorded().reader);
  const auto shared = read_central_study(recorded().lab.admit("ben", central::Admission::SharedReader));
  const std::string unshared = "SELECT count(*) FROM session JOIN sharing USING (person) WHERE granted = 0";
  EXPECT_EQ(lab->integer(unshared), 1);
  EXPECT_EQ(shared->integer(unshared), 0);
  EXPECT_EQ(lab->integer("SELECT count(*) FROM session"),
            1 + shared->integer("SELECT count(*) FROM session"));
  EXPECT_EQ(shared->integer("SELECT count(*) FROM note"), 0);
}

TEST(CentralReading, ReadersOpenAServiceAndWritersRefuseIt) {
  const fs::path central = "service:" + recorded().reader;
  read_central_with(read_central_study);
  EXPECT_EQ(read_tasks(central).protocols.size(), 2u);
  const auto refused = ThrowsMessage<base::Error>(HasSubstr("is a central database"));
  EXPECT_THAT([&] { Store(central, Open::Create); }, refused);
  EXPECT_THAT([&] { withdraw(central, "P01"); }, refused);
  EXPECT_THAT([&] { merge({recorded().files[0]}, central); }, refused);
  EXPECT_THAT([&] { study::push(central, recorded().services[0]); }, refused);
  EXPECT_THAT([&] { withdrawn_at_centre(central, recorded().services[0]); }, refused);
  EXPECT_FALSE(fs::exists(central));
}

TEST(CentralReading, AStationIsNoReaderAndAnotherSchemaIsNamed) {
  EXPECT_THAT([] { read_central_study(recorded().services[0]); },
              ThrowsMessage<base::Error>(HasSubstr("may read neither")));
  recorded().lab.ask("UPDATE vip.schema_version SET number = number - 1");
  EXPECT_THAT([] { read_central_study(recorded().reader); },
              ThrowsMessage<base::Error>(HasSubstr("vip-study central upgrade")));
  recorded().lab.ask("UPDATE vip.schema_version SET number = number + 1");
}

}  // namespace
}  // namespace study
