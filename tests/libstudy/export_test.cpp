#include "libstudy/store/export_csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "libstudy/store/database.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

fs::path make_study(const test::TemporaryFolder& folder) {
  Store store(folder / "study.db", sqlite::Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = store.open_runs().at(0).sessions.at(0);
  const auto id = store.begin_presentation(session.id, session.trials[0].id, 1, 0);
  store.end_presentation(id, 0, 1, test::frames(0, 5), {});
  store.answer(session.id, session.trials[0].id, id, "satisfaction", 6, 0.5, 2);
  return folder / "study.db";
}

TEST(ExportCsv, WritesEveryTableOnceAndAgainTheSame) {
  const test::TemporaryFolder folder;
  const fs::path database = make_study(folder);
  const auto files = export_csv(database, folder / "out");
  EXPECT_EQ(files.size(), 11u);
  EXPECT_THAT(test::bytes_of(folder / "out" / "responses.csv"),
              ::testing::StartsWith("response_id,trial_id,presentation_id,question_id,score,response_time_s,"
                                    "answered_utc\r\n1,1,1,1,6,0.5,2"));
  EXPECT_THAT(test::bytes_of(folder / "out" / "frames.csv"),
              HasSubstr("\r\n1,3,8,0.30000000000000004,60000000,1003,2000,,,1,100 800,0.75,-2.5\r\n"));
  EXPECT_EQ(test::bytes_of(folder / "out" / ("protocol_" + test::pilot().sha256.substr(0, 12) + ".toml")),
            test::pilot().text);

  const std::string before = test::bytes_of(folder / "out" / "frames.csv");
  export_csv(database, folder / "out/");
  EXPECT_TRUE(test::bytes_of(folder / "out" / "frames.csv") == before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);
}

TEST(ExportCsv, DictionaryTellsEveryColumnOfTheSchema) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  sqlite::Statement table(*database, "SELECT name, sql FROM sqlite_schema WHERE type = 'table'");
  int tables = 0;
  while (table.step()) {
    ++tables;
    const auto columns = column_meanings(table.text(0), table.text(1));
    sqlite::Statement info(*database, "SELECT name, type FROM pragma_table_info(?)");
    info.bind(0, table.text(0));
    for (const ColumnMeaning& column : columns) {
      ASSERT_TRUE(info.step()) << table.text(0);
      EXPECT_EQ(column.column, info.text(0));
      EXPECT_EQ(column.type, info.text(1));
      EXPECT_FALSE(column.meaning.empty()) << column.table << "." << column.column;
    }
    EXPECT_FALSE(info.step()) << table.text(0);
  }
  EXPECT_EQ(tables, 9);
}

TEST(ExportCsv, RatingsHoldEveryPlannedTrialOnce) {
  const test::TemporaryFolder folder;
  export_csv(make_study(folder), folder / "out");
  const std::string ratings = test::bytes_of(folder / "out" / "ratings.csv");
  EXPECT_EQ(std::count(ratings.begin(), ratings.end(), '\n'), 1 + 21);
  EXPECT_THAT(ratings, ::testing::StartsWith("trial_id,protocol,protocol_version,participant,visit,"));
  EXPECT_THAT(ratings, HasSubstr("\r\n1,ptpe_pilot,1.0,P01,1,0,\"ptpe:a=31,b=0.035\",virtual,0,0,"));
  EXPECT_THAT(ratings, HasSubstr(",satisfaction,6,0.5,1,fail,D,"));
  EXPECT_THAT(ratings, HasSubstr(",satisfaction,,,,,,"));  // not answered yet
  const std::string dictionary = test::bytes_of(folder / "out" / "dictionary.csv");
  const std::string names = ratings.substr(0, ratings.find('\r'));
  std::istringstream header(names);
  for (std::string name; std::getline(header, name, ',');) {
    const std::size_t at = dictionary.find("\nratings.csv," + name + ",");
    ASSERT_NE(at, std::string::npos) << name;
    const std::string line = dictionary.substr(at + 1, dictionary.find('\r', at) - at - 1);
    EXPECT_NE(line.back(), ',') << line << " says nothing";
  }
}

TEST(ExportCsv, QuotesWhatNeedsIt) {
  const test::TemporaryFolder folder;
  make_study(folder);
  Protocol protocol = test::pilot();
  std::string text = protocol.text;
  const std::string wording = "How satisfied are you with the step speed and the smoothness of the fluid?";
  text.replace(text.find(wording), wording.size(), "Happy, \\\"or\\\" not?");
  text.replace(text.find("\"1.0\""), 5, "\"1.1\"");
  Store(folder / "study.db", sqlite::Open::Write)
      .add_run(test::run_plan(parse_protocol(text, "changed"), {"P01"}));
  export_csv(folder / "study.db", folder / "out");
  EXPECT_THAT(test::bytes_of(folder / "out" / "questions.csv"), HasSubstr(",\"Happy, \"\"or\"\" not?\","));
}

TEST(ExportCsv, LeavesWhatIsNotOursAlone) {
  const test::TemporaryFolder folder;
  const fs::path database = make_study(folder);
  fs::create_directory(folder / "mine");
  base::write_file_atomically(folder / "mine" / "notes.txt", "keep");
  base::write_file_atomically(folder / "file", "keep");
  export_csv(database, folder / "mixed");
  base::write_file_atomically(folder / "mixed" / "notes.txt", "keep");
  fs::create_directory(folder / "namesake");
  base::write_file_atomically(folder / "namesake" / "dictionary.csv", "other words");
  const auto files = std::distance(fs::recursive_directory_iterator(folder.path()), {});
  for (const char* target : {"mine", "file", "mixed", "namesake", "study.db"}) {
    EXPECT_THAT([&] { export_csv(database, folder / target); },
                ThrowsMessage<base::Error>(HasSubstr("is not an earlier export")));
  }
  EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder.path()), {}), files);
  EXPECT_EQ(test::bytes_of(folder / "namesake" / "dictionary.csv"), "other words");
  fs::create_directory(folder / "empty");
  EXPECT_EQ(export_csv(database, folder / "empty").size(), 11u);
}

}  // namespace
}  // namespace study
