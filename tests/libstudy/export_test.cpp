#include "libstudy/store/export/export_csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "libstudy/store/file/database.hpp"
#include "stats/base/error.hpp"
#include "tests/common/tables.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::test::read_csv;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

fs::path make_study(const test::TemporaryFolder& folder) {
  Store store(folder / "study.db", sqlite::Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = store.open_runs().at(0).sessions.at(0);
  const OpenUnit& unit = session.units.at(2);
  test::show(store, session, unit, 5);
  const KeptAnswer kept{"satisfaction", {test::score(6), 0.5}};
  store.answer(session.id, unit, 1, {&kept, 1}, true, 2);
  store.exclude_trial(session.id, session.units.at(3).trial_id, "sneezed");
  store.note(session.id, {}, "a loud street");
  return folder / "study.db";
}

TEST(ExportCsv, WritesEveryTableOnceAndAgainTheSame) {
  const test::TemporaryFolder folder;
  const fs::path database = make_study(folder);
  const auto files = export_csv(database, folder / "out");
  EXPECT_EQ(files.size(), 26u);
  EXPECT_THAT(test::bytes_of(folder / "out" / "responses.csv"),
              ::testing::StartsWith("response_id,unit_id,attempt,question_id,score,response_time_s,"
                                    "answered_utc,input,counts,why_not\r\n1,3,1,2,6,0.5,2"));
  EXPECT_THAT(test::bytes_of(folder / "out" / "frames.csv"),
              HasSubstr("\r\n1,3,8,0.30000000000000004,60000000,1003,2000,,,1,100 "
                        "800,0.75,-2.5,0.875,18,4,1,2,3,4,5,6,7,8\r\n"));
  EXPECT_EQ(test::bytes_of(folder / "out" / ("protocol_" + test::pilot().sha256.substr(0, 12) + ".toml")),
            test::pilot().text);

  const std::string before = test::bytes_of(folder / "out" / "frames.csv");
  export_csv(database, folder / "out/");
  EXPECT_TRUE(test::bytes_of(folder / "out" / "frames.csv") == before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 3);  // database, its journal, "out"
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
    info.bind_all(table.text(0));
    for (const ColumnMeaning& column : columns) {
      ASSERT_TRUE(info.step()) << table.text(0);
      EXPECT_EQ(column.column, info.text(0));
      EXPECT_EQ(column.type, info.text(1));
      EXPECT_FALSE(column.meaning.empty()) << column.table << "." << column.column;
    }
    EXPECT_FALSE(info.step()) << table.text(0);
  }
  EXPECT_EQ(tables, 30);
}

TEST(ExportCsv, RatingsHoldEveryPlannedTrialOnce) {
  const test::TemporaryFolder folder;
  export_csv(make_study(folder), folder / "out");
  auto rows = read_csv(folder / "out" / "ratings.csv");
  ASSERT_EQ(rows.size(), 21u);
  EXPECT_EQ(rows[0]["participant"], "P01");
  EXPECT_EQ(rows[0]["block_kind"], "stimulus");
  EXPECT_EQ(rows[0]["first_scene"], "data/scenes/single_dam.toml");
  EXPECT_EQ(rows[0]["first_method"], "HiRes");
  EXPECT_EQ(rows[0]["second_method"], "");
  EXPECT_EQ(rows[0]["question"], "satisfaction");
  EXPECT_EQ(rows[0]["score"], "6");
  EXPECT_EQ(rows[0]["first_verdict"], "degraded");
  EXPECT_EQ(rows[0]["first_mean_fps"], "49.5");
  EXPECT_EQ(rows[0]["excluded"], "0");
  EXPECT_EQ(rows[1]["score"], "");  // not answered yet
  EXPECT_EQ(rows[1]["excluded"], "1");
  const std::string ratings = test::bytes_of(folder / "out" / "ratings.csv");
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

TEST(ExportCsv, RatingsTellBothIntervalsOfAPairAndEachQuestion) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", sqlite::Open::Create);
    store.add_run(test::run_plan(test::pairs(), {"P01"}));
    const auto session = store.open_runs().at(0).sessions.at(0);
    const OpenUnit& practice = session.units.at(1);
    const int attempt = test::show(store, session, practice);
    const std::vector<KeptAnswer> kept{{"preference", {test::score(2), 1}}, {"ease", {test::score(5), 1}}};
    store.answer(session.id, practice, attempt, kept, true, 1);
  }
  export_csv(folder / "study.db", folder / "out");
  auto rows = read_csv(folder / "out" / "ratings.csv");
  ASSERT_EQ(rows.size(), 4u * 2u);  // a practice trial and three pairs, two questions each
  EXPECT_EQ(rows[0]["block_kind"], "practice");
  EXPECT_EQ(rows[0]["question"], "preference");
  EXPECT_EQ(rows[1]["question"], "ease");
  EXPECT_EQ(rows[2]["block_kind"], "stimulus");
  EXPECT_NE(rows[0]["first_method"], rows[0]["second_method"]);
  EXPECT_EQ(rows[0]["second_mean_fps"], "49.5");
  EXPECT_EQ(rows[0]["score"], "2");
  EXPECT_EQ(rows[2]["second_mean_fps"], "");
}

TEST(ExportCsv, FreeWordsLeaveTheDatabaseOnDemandAlone) {
  const test::TemporaryFolder folder;
  const fs::path database = make_study(folder);
  const auto has_note = [&](const char* name) {
    for (const auto& entry : fs::directory_iterator(folder / name)) {
      if (test::bytes_of(entry.path()).find("a loud street") != std::string::npos) return true;
    }
    return false;
  };
  export_csv(database, folder / "plain");
  EXPECT_FALSE(has_note("plain"));
  EXPECT_EQ(export_csv(database, folder / "words", {.words = true}).size(), 28u);
  EXPECT_TRUE(has_note("words"));
}

TEST(ExportCsv, TheDatabaseRemembersTheFolder) {
  const test::TemporaryFolder folder;
  const fs::path database = make_study(folder);
  export_csv(database, folder / "out/");
  sqlite::Connection look(database, sqlite::Open::Read);
  EXPECT_EQ(look.text("SELECT detail FROM event WHERE kind = 'export'"), (folder / "out").string());
}

TEST(ExportCsv, QuotesWhatNeedsIt) {
  const test::TemporaryFolder folder;
  make_study(folder);
  const std::string text = test::replaced(
      test::with_keys(test::shipped_text("ptpe_pilot"), {{"version", "\"2.1\""}}),
      "How satisfied are you with the step speed and the smoothness of the fluid?", "Happy, \\\"or\\\" not?");
  Store(folder / "study.db", sqlite::Open::Write)
      .add_run(test::run_plan(parse_protocol(text, "changed"), {"P01"}));
  export_csv(folder / "study.db", folder / "out");
  EXPECT_THAT(test::bytes_of(folder / "out" / "questions.csv"), HasSubstr(",\"Happy, \"\"or\"\" not?\","));
}

// The format that LibreOffice and Excel expect at a double click in locales that write 0,5.
TEST(ExportCsv, ForSpreadsheetsHasTheLocalesMarks) {
  const test::TemporaryFolder folder;
  const fs::path database = make_study(folder);
  export_csv(database, folder / "out", {.words = true, .gaze = false, .dialect = {';', ',', true}});
  for (const auto& entry : fs::directory_iterator(folder / "out")) {
    if (entry.path().extension() != ".csv") continue;
    EXPECT_THAT(test::bytes_of(entry.path()), ::testing::StartsWith("\xEF\xBB\xBF")) << entry.path();
  }
  EXPECT_THAT(
      test::bytes_of(folder / "out" / "responses.csv"),
      ::testing::StartsWith("\xEF\xBB\xBFresponse_id;unit_id;attempt;question_id;score;response_time_s;"
                            "answered_utc;input;counts;why_not\r\n1;3;1;2;6;0,5;2"));
  EXPECT_THAT(
      test::bytes_of(folder / "out" / "dictionary.csv"),
      HasSubstr("(all);(all);TEXT;\"written for spreadsheets (--excel): UTF-8 behind a byte-order mark, "
                "';' between fields, ',' as the decimal mark. R reads it by read.csv2("));
  EXPECT_EQ(csv_field("a;b", {';', ',', true}), "\"a;b\"");
  EXPECT_EQ(csv_field("a,b", {';', ',', true}), "a,b");
  export_csv(database, folder / "out");  // the earlier export with other marks is recognised and replaced
  EXPECT_THAT(test::bytes_of(folder / "out" / "dictionary.csv"), ::testing::StartsWith("file,column,"));
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
  EXPECT_THAT([&] { export_csv(database, folder / "mixed"); },
              ThrowsMessage<base::Error>(HasSubstr(": 'notes.txt' was added")));
  EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder.path()), {}), files);
  EXPECT_EQ(test::bytes_of(folder / "namesake" / "dictionary.csv"), "other words");
  fs::create_directory(folder / "empty");
  EXPECT_EQ(export_csv(database, folder / "empty").size(), 26u);
}

}  // namespace
}  // namespace study
