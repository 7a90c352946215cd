#include "libstudy/store/import/read_import.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <string>

#include "libstudy/protocol/find_protocol.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/store.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// A pilot with the settings (10, 0) and (20, 0) and the question "satisfaction", 1 to 7.
Protocol two_settings() {
  std::string text = base::read_file(base::resource("protocols/ptpe_pilot.toml"), 1 << 20);
  const auto replace = [&](const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    text.replace(at, from.size(), to);
  };
  replace("mean_fps = [10, 20, 30, 40, 50]", "mean_fps = [10, 20]");
  replace("sd_fps = [0, 5, 10, 15, 20]", "sd_fps = [0]");
  return parse_protocol(text, "two.toml");
}

const std::string head = "format = 1\ntool = \"Own tool\"\n";
const std::string columns =
    "[columns]\nperson = \"who\"\norder = \"n\"\nmean_fps = \"mean\"\nsd_fps = \"sd\"\n"
    "[[answer]]\nquestion = \"satisfaction\"\ncolumn = \"score\"\n";
const std::string table = "who,n,mean,sd,score\nP01,1,10,0,3\nP01,2,20,0,5\n";

class Import : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  ReadImport read(const std::string& mapping, const std::string& text) const {
    return read_import(two_settings(), read_mapping(write("map.toml", mapping)), {write("t.csv", text)});
  }

  void expect_refusal(const std::string& mapping, const std::string& text, const std::string& words) const {
    EXPECT_THAT([&] { read(mapping, text); }, ThrowsMessage<base::Error>(HasSubstr(words)));
  }

  ImportTerms terms() const { return {"Own tool", true, "stopped", "{}", std::string(64, 'm')}; }

  const test::TemporaryFolder folder_;
};

TEST_F(Import, TrialsStandInTheOrderOfTheirNumbers) {
  const ReadImport all = read(head + columns,
                              "who,n,mean,sd,score\nP02,7,20,0,5\nP01,2,20,0,6\nP01,1,10,0,3\n"
                              "P02,3,10,0,2\n");
  ASSERT_EQ(all.sessions.size(), 2u);
  EXPECT_EQ(all.sessions[0].participant, "P01");
  ASSERT_EQ(all.sessions[1].trials.size(), 2u);
  EXPECT_EQ(all.sessions[1].trials[0].cells().at(0), 0);
  EXPECT_EQ(all.sessions[1].trials[0].answers.at(0).score, 2);
  EXPECT_EQ(all.sessions[1].trials[1].answers.at(0).score, 5);
  EXPECT_EQ(all.sources.at(0).sha256, base::sha256_of_file(folder_ / "t.csv"));
}

TEST_F(Import, ReadsQuotesSeparatorsAndMarks) {
  const ReadImport all =
      read(head +
               "missing = [\"null\"]\n[[row]]\ncolumn = \"kind\"\nis = [\"rate\"]\n"
               "[columns]\nperson = \"who\"\norder = \"n\"\nmean_fps = \"mean\"\nsd_fps = \"sd\"\n"
               "[[answer]]\nquestion = \"satisfaction\"\ncolumn = \"a\"\nkey = \"q\"\nadd = 1\n"
               "response_time_ms = \"rt\"\n",
           "\xEF\xBB\xBFwho;n;mean;sd;a;rt;kind;\r\n"
           "P01;1;10,0;0;\"{\"\"q\"\":2}\";\"1500,5\";rate;\r\n"
           "P01;2;;;\"two\nlines; here\";;text;\r\n"
           "P01;3;20;0;\"{\"\"q\"\":null}\";;rate;\r\n\r\n");
  ASSERT_EQ(all.sessions.at(0).trials.size(), 2u);
  const ImportedAnswer answer = all.sessions[0].trials[0].answers.at(0);
  EXPECT_EQ(answer.score, 3);
  EXPECT_DOUBLE_EQ(answer.response_time_s.value(), 1.5005);
  EXPECT_FALSE(all.sessions[0].trials[1].answers.at(0).score);
  EXPECT_EQ(all.sources.at(0).rows, 3u);
  EXPECT_EQ(all.sources.at(0).used, 2u);
}

TEST_F(Import, RefusesWhatItWouldHaveToGuess) {
  const std::string people =
      "[columns]\norder = \"n\"\nmean_fps = \"mean\"\nsd_fps = \"sd\"\n"
      "[[answer]]\nquestion = \"satisfaction\"\ncolumn = \"score\"\n";
  expect_refusal(head + people, table, "without a column of people");
  EXPECT_EQ(read(head + "only_person = \"P09\"\n" + people, table).sessions.at(0).participant, "P09");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,10,0,3\n", "has 1 of the 2 trials of P01");
  EXPECT_FALSE(read(head + "incomplete = \"stopped\"\n" + columns, "who,n,mean,sd,score\nP01,1,10,0,3\n")
                   .sessions.at(0)
                   .complete);
  expect_refusal(head + columns, table + "P01,3,20,0,5\n", "t.csv:4: shows cell 1 to P01 more often");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,10,0,3\nP01,1,20,0,5\n",
                 "t.csv:3, column n: \"1\" is the number of another trial of P01");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,10,0,3\nP01,1,10,0,5\n", "is a second answer");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,15,0,3\n", "mean \"15\", sd \"0\" is no cell");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,nan,0,3\n", "column mean: \"nan\" is no number");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,10,0,8\n",
                 "t.csv:2, column score: \"8\" is no answer");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,10,0,3.5\n", "\"3.5\" is no answer");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,10,0,\n", "\"\" is no answer");
  expect_refusal(head + columns, "who,n,mean,sd,score\nAnna B.,1,10,0,3\n", "is not a participant code");
  expect_refusal(head + columns, "who,n,mean,score\nP01,1,10,3\n", "has no column sd");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,10,0\n", "t.csv:2: has 4 fields where");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP01,1,\"10,0,3\n", "t.csv:2: opens a quote");
  expect_refusal(head + columns, "who,n,mean,sd,score\nP\xE9,1,10,0,3\n", "t.csv:2: is no text in UTF-8");
  expect_refusal(head + columns, "", "t.csv: is empty");
  expect_refusal(head + columns, "who,n,mean,sd,score\n", "has no row that the mapping takes");
  expect_refusal(head + columns + "colour = \"red\"\n", table, "map.toml:");
  expect_refusal(head +
                     "[columns]\nperson = \"who\"\norder = \"n\"\n[[answer]]\nquestion = \"satisfaction\"\n"
                     "column = \"score\"\n",
                 table, "so 2 cells of protocol ptpe_pilot 2.0 fit");
  expect_refusal(
      head +
          "[columns]\nperson = \"who\"\norder = \"n\"\nmean_fps = \"mean\"\n[[answer]]\nquestion = "
          "\"joy\"\ncolumn = \"score\"\n",
      table, "question 'joy' of the mapping");
}

TEST_F(Import, OneVisitComesFromOneFile) {
  const ImportMapping mapping = read_mapping(write("map.toml", head + columns));
  const fs::path one = write("a/t.csv", table), other = write("b/t.csv", table + "\n");
  EXPECT_THAT(
      [&] {
        read_import(two_settings(), mapping, {one, other});
      },
      ThrowsMessage<base::Error>(HasSubstr("is of visit 1 of P01, which")));
  write("b/t.csv", table);
  EXPECT_THAT(
      [&] {
        read_import(two_settings(), mapping, {one, other});
      },
      ThrowsMessage<base::Error>(HasSubstr("holds the same bytes as")));
  EXPECT_THAT([&] { find_sources({folder_ / "a"}, mapping); },
              ThrowsMessage<base::Error>(HasSubstr("does not name the tables")));
}

TEST_F(Import, TimesOfDayBecomeUtc) {
  const auto utc = [&](const std::string& time, const std::string& offset) {
    return read(head + offset +
                    "[columns]\nperson = \"who\"\norder = \"n\"\nmean_fps = \"mean\"\nsd_fps = \"sd\"\n"
                    "answered = \"at\"\n[[answer]]\nquestion = \"satisfaction\"\ncolumn = \"score\"\n",
                "who,n,mean,sd,score,at\nP01,1,10,0,3," + time + "\nP01,2,20,0,3," + time + "\n")
        .sessions.at(0)
        .trials.at(0)
        .utc.value();
  };
  EXPECT_EQ(utc("2026-01-31T01:00:00.5+02:00", ""), "2026-01-30T23:00:00Z");
  EXPECT_EQ(utc("2026-01-31_13h00.07.123", "utc_offset = \"-05:30\"\n"), "2026-01-31T18:30:07Z");
  EXPECT_EQ(utc("2026-01-31 13:00:00Z", ""), "2026-01-31T13:00:00Z");
  EXPECT_THAT([&] { utc("2026-01-31 13:00:00", ""); },
              ThrowsMessage<base::Error>(HasSubstr("has no offset from UTC")));
  EXPECT_THAT([&] { utc("2999-01-31 13:00:00Z", ""); },
              ThrowsMessage<base::Error>(HasSubstr("in the future")));
  EXPECT_THAT([&] { utc("yesterday", ""); }, ThrowsMessage<base::Error>(HasSubstr("is no time of day")));
}

/// A frame log of `count` frames of `ms`, as PresentMon writes it.
std::string log_of(int count, double ms) {
  std::string out = "MsBetweenPresents\n";
  for (int i = 0; i < count; ++i) out += std::to_string(ms) + "\n";
  return out;
}

TEST_F(Import, FramesGiveAVerdictAndTheirAbsenceGivesNone) {
  const std::string mapping = head + columns + "[frames]\nfile = \"log_{n}.csv\"\nmay_lack = true\n";
  write("log_1.csv", log_of(100, 100));
  ReadImport all = read(mapping, table);
  Store(folder_ / "s.db", sqlite::Open::Create).add_import(two_settings(), terms(), all.sessions);
  const TaskStudy stored = read_tasks(folder_ / "s.db");
  const auto& trials = stored.protocols.at(0).sessions.at(0).trials;
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_EQ(trials[0].first.verdict, Verdict::Pass);
  EXPECT_TRUE(trials[0].first.framed);
  EXPECT_EQ(trials[0].first.realised.frames, 100u);
  EXPECT_NEAR(trials[0].first.realised.mean, 10, 1e-9);
  EXPECT_FALSE(trials[1].first.verdict);
  EXPECT_FALSE(trials[1].first.framed || trials[1].first.has_rates());
  sqlite::Connection database(folder_ / "s.db", sqlite::Open::Read);
  EXPECT_EQ(database.integer("SELECT count(*) FROM frame WHERE late IS NULL AND content_step IS NULL"), 100);
  EXPECT_EQ(database.text("SELECT group_concat(scheduled_ns, ' ') FROM frame WHERE frame_index < 3"),
            "0 100000000 200000000");
  EXPECT_EQ(database.text("SELECT detail FROM event WHERE kind = 'frames imported'"),
            "SHA-256 of the log " + base::sha256_of_file(folder_ / "log_1.csv"));
  const SessionRow row = read_status(folder_ / "s.db").sessions.at(0);
  EXPECT_EQ(row.imported_from, "Own tool");
  EXPECT_EQ(row.not_recorded, 1);
  EXPECT_EQ(row.state, "done");
  EXPECT_EQ(row.sharing, true);
  EXPECT_FALSE(row.gaze);

  expect_refusal(head + columns + "[frames]\nfile = \"log_{n}.csv\"\n", table, "t.csv:3: has no frame log");
  write("log_2.csv", "FPS\n20\n20\n");
  expect_refusal(mapping, table, "log_2.csv");
  fs::copy_file(folder_ / "log_1.csv", folder_ / "log_2.csv", fs::copy_options::overwrite_existing);
  expect_refusal(mapping, table, "has the same frame log as");
}

TEST_F(Import, AFrameLogThatIsShorterThanItsTrialFails) {
  write("log_1.csv", log_of(3, 100));
  const std::string mapping = head + columns + "[frames]\nfile = \"log_{n}.csv\"\nmay_lack = true\n";
  Store(folder_ / "s.db", sqlite::Open::Create)
      .add_import(two_settings(), terms(), read(mapping, table).sessions);
  sqlite::Connection database(folder_ / "s.db", sqlite::Open::Read);
  EXPECT_EQ(database.text("SELECT verdict || ': ' || reason FROM presentation WHERE frames = 3"),
            "fail: the log lasts 0.3 s, the trial 10 s");
}

TEST_F(Import, SurvivesADamagedDatabase) {
  const ReadImport all = read(head + columns, table);
  Store(folder_ / "s.db", sqlite::Open::Create).add_import(two_settings(), terms(), all.sessions);
  const auto marks = [](const fs::path& path) {
    return sqlite::Connection(path, sqlite::Open::Read)
        .text(
            "SELECT imported_from || source_sha256 || (SELECT group_concat(score) FROM response) || (SELECT "
            "count(*) FROM response WHERE answered_utc IS NULL AND response_time_s IS NULL) FROM session");
  };
  const std::string before = marks(folder_ / "s.db");
  EXPECT_THAT(before, HasSubstr("3,52"));
  std::string bytes = test::bytes_of(folder_ / "s.db");
  std::fill_n(bytes.begin(), 100, '\0');  // without its header the file is read page by page
  base::write_file_atomically(folder_ / "s.db", bytes);
  fs::remove(folder_ / "s.db.answers.jsonl");
  salvage(folder_ / "s.db", folder_ / "new.db");
  EXPECT_EQ(marks(folder_ / "new.db"), before);
}

const std::string json_columns =
    "missing = [\"\"]\n[[row]]\ncolumn = \"kind\"\nis = \"rate\"\n"
    "[columns]\nperson = \"who\"\norder = \"n\"\nmean_fps = \"mean\"\nsd_fps = \"sd\"\n"
    "[[answer]]\nquestion = \"satisfaction\"\ncolumn = \"a\"\nkey = \"q\"\nresponse_time_s = \"rt\"\n";

TEST_F(Import, JsonIsReadAsTheCsvOfTheSameTrials) {
  const ImportMapping mapping = read_mapping(write("map.toml", head + json_columns));
  const auto sessions = [&](const char* name, const std::string& text) {
    return read_import(two_settings(), mapping, {write(name, text)}).sessions;
  };
  const auto csv =
      sessions("t.csv",
               "who,n,kind,mean,sd,a,rt\nP01,1,rate,10.0,0,\"{\"\"q\"\": 2}\",1.5\nP01,2,text,,,hi,\n"
               "P01,3,rate,20,0,,\n");
  const auto json = sessions(
      "t.json", R"([{"who": "P01", "n": 1, "kind": "rate", "mean": 10.0, "sd": 0, "a": {"q": 2}, "rt": 1.5},)"
                R"( {"who": "P01", "n": 2, "kind": "text", "a": "hi", "extra": [1, {"x": null}]},)"
                R"( {"kind": "rate", "who": "P01", "n": 3, "mean": 20, "sd": 0, "a": null, "rt": null}])");
  ASSERT_EQ(csv.size(), 1u);
  ASSERT_EQ(json.size(), 1u);
  ASSERT_EQ(json[0].trials.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(json[0].trials[i].cells(), csv[0].trials[i].cells());
    EXPECT_EQ(json[0].trials[i].answers.at(0).score, csv[0].trials[i].answers.at(0).score);
    EXPECT_EQ(json[0].trials[i].answers.at(0).response_time_s,
              csv[0].trials[i].answers.at(0).response_time_s);
  }
  EXPECT_EQ(json[0].trials[0].answers.at(0).score, 2);
  EXPECT_FALSE(json[0].trials[1].answers.at(0).score);

  const auto refused = [&](const std::string& text, const char* words) {
    EXPECT_THAT([&] { sessions("t.json", text); }, ThrowsMessage<base::Error>(HasSubstr(words))) << text;
  };
  refused("", "t.json: is no whole JSON text: it ends too early");
  refused(R"([{"who": "P01", "n": 1, "ki)", "t.json: is no whole JSON text");
  refused("[{\"who\": \"P\xE9\"}]", "t.json: is no whole JSON text");
  refused("[]", "t.json: is no JSON list with entries");
  refused(R"({"trials": []})", "t.json: is no JSON list with entries");
  refused("[1]", "t.json: entry 1: is no object");
  refused(R"([{"who": "P01"}])", "has no column");
  refused(R"([{"who": "P01", "n": 1, "kind": "rate", "mean": "NaN", "sd": 0, "a": {"q": 2}, "rt": 1}])",
          "t.json: entry 1, column mean: \"NaN\" is no number");
  refused(R"([{"who": "P01", "n": 1, "kind": "rate", "mean": 10, "sd": 0, "a": {"p": 2}, "rt": 1}])",
          "t.json: entry 1, column a: ");
}

/// A CSV table with the pairs of Task 2's first group. Of each pair the later cell is shown first. The column
/// "chosen" holds the name of the method that the person chose.
std::string pairs_of(const Protocol& protocol, const std::string& person) {
  std::string out;
  int n = 0;
  for (const auto& [a, b] : pairs_of_group(protocol.design, cell_groups(protocol.design).front())) {
    const StimulusSpec& one = protocol.design.cells.at(static_cast<std::size_t>(b)).stimulus;
    const StimulusSpec& other = protocol.design.cells.at(static_cast<std::size_t>(a)).stimulus;
    ++n;
    out += person + "," + std::to_string(n) + "," + one.scene + "," + one.method + "," + other.method + "," +
           (n % 3 == 0 ? one.method : other.method) + "\n";
  }
  return out;
}
const std::string pair_columns =
    "[columns]\nperson = \"who\"\norder = \"n\"\nscene = \"scene\"\n[columns.first]\nmethod = \"left\"\n"
    "[columns.second]\nmethod = \"right\"\n[[answer]]\nquestion = \"preference\"\ncolumn = \"chosen\"\n";

TEST_F(Import, ReadsChoicesBetweenPairs) {
  const Protocol protocol = read_protocol(find_protocol("task2"));
  const std::string names = "who,n,scene,left,right,chosen\n",
                    by_name = "choice_of = [\"left\", \"right\"]\n";
  const auto imported = [&](const std::string& mapping, const std::string& text) {
    return read_import(protocol, read_mapping(write("map.toml", head + mapping)), {write("t.csv", text)});
  };
  const ReadImport all = imported(pair_columns + by_name, names + pairs_of(protocol, "P01"));
  const auto& trials = all.sessions.at(0).trials;
  ASSERT_EQ(trials.size(), 10u);
  EXPECT_TRUE(all.sessions[0].complete);
  EXPECT_EQ(trials[0].cells(), (std::vector<int>{1, 0}));
  EXPECT_EQ(trials[0].answers.at(0).score, 2);
  EXPECT_EQ(trials[2].answers.at(0).score, 1);
  Store(folder_ / "s.db", sqlite::Open::Create).add_import(protocol, terms(), all.sessions);
  const TaskStudy study = read_tasks(folder_ / "s.db");
  const auto& stored = study.protocols.at(0).sessions.at(0).trials;
  ASSERT_EQ(stored.size(), 10u);
  const auto method = [&](int cell) {
    return protocol.design.cells.at(static_cast<std::size_t>(cell)).stimulus.method;
  };
  for (std::size_t i = 0; i < stored.size(); ++i) {
    EXPECT_EQ(stored[i].first.what.method, method(trials[i].cells()[0]));
    ASSERT_TRUE(stored[i].second);
    EXPECT_EQ(stored[i].second->what.method, method(trials[i].cells()[1]));
    EXPECT_EQ(stored[i].answers.at(0).score, trials[i].answers.at(0).score);
  }
  EXPECT_EQ(read_status(folder_ / "s.db").sessions.at(0).showings, 20);

  const std::string rows = pairs_of(protocol, "P01"), scene = protocol.design.cells.front().stimulus.scene;
  const auto refused = [&](const std::string& mapping, const std::string& text, const char* words) {
    EXPECT_THAT([&] { imported(mapping, names + text); }, ThrowsMessage<base::Error>(HasSubstr(words)));
  };
  refused(pair_columns + by_name, "P01,1," + scene + ",HiRes,Ours,Best\n",
          "\"Best\" names neither stimulus of the pair");
  refused(pair_columns + by_name, "P01,1," + scene + ",HiRes,HiRes,HiRes\n",
          "names both stimuli of the pair");
  refused(pair_columns, "P01,1," + scene + ",HiRes,HiRes,1\n",
          "in one trial, which the protocol does not pair");
  refused(pair_columns + by_name,
          rows + "P01,11" + rows.substr(rows.find(",1,") + 2, rows.find('\n') - rows.find(",1,") - 1),
          "t.csv:12: shows cells 0 and 1 to P01 more often");
  refused(pair_columns, rows, "is no answer to question 'preference'");
  refused(
      "[columns]\nperson = \"who\"\norder = \"n\"\nmethod = \"left\"\n[[answer]]\nquestion = \"preference\"\n"
      "column = \"chosen\"\n",
      rows, "shows pairs, and the mapping names the columns of one stimulus");
  refused(
      "[columns]\nperson = \"who\"\norder = \"n\"\n[columns.first]\nmethod = \"left\"\n[[answer]]\n"
      "question = \"preference\"\ncolumn = \"chosen\"\n",
      rows, "second");
  expect_refusal(head +
                     "[columns]\nperson = \"who\"\norder = \"n\"\n[columns.first]\nmean_fps = \"mean\"\n"
                     "[columns.second]\nmean_fps = \"mean\"\n[[answer]]\nquestion = \"satisfaction\"\n"
                     "column = \"score\"\n",
                 table, "shows one stimulus in a trial, and the mapping names the columns of two");
}

TEST_F(Import, IsAllOrNothing) {
  ReadImport all = read(head + columns, table + "P02,1,10,0,3\nP02,2,20,0,5\n");
  all.sessions[1].trials[1].showings[0].cell = -1;  // SQLite refuses this cell
  EXPECT_THROW(
      Store(folder_ / "s.db", sqlite::Open::Create).add_import(two_settings(), terms(), all.sessions),
      std::exception);
  EXPECT_FALSE(fs::exists(folder_ / "s.db"));
}

TEST_F(Import, APersonWhoWithdrewDoesNotComeBack) {
  const ReadImport all = read(head + columns, table + "P02,1,10,0,3\nP02,2,20,0,5\n");
  Store(folder_ / "s.db", sqlite::Open::Create).add_import(two_settings(), terms(), all.sessions);
  const Withdrawal done = withdraw(folder_ / "s.db", "P01");
  EXPECT_TRUE(done.deleted.stations.empty());
  ASSERT_EQ(done.deleted.sources.size(), 1u);
  EXPECT_EQ(done.deleted.sources[0], "Own tool, SHA-256 " + all.sessions.at(0).source_sha256);
  const std::vector<ImportedSession> again{all.sessions.at(0)};
  EXPECT_THROW(Store(folder_ / "s.db", sqlite::Open::Write).add_import(two_settings(), terms(), again),
               base::Error);
  // The same people of the same source have the same identities in any database.
  Store(folder_ / "t.db", sqlite::Open::Create).add_import(two_settings(), terms(), all.sessions);
  const auto identities = [&](const char* name, const char* column) {
    return sqlite::Connection(folder_ / name, sqlite::Open::Read)
        .text(std::string("SELECT ") + column + " FROM session WHERE participant = 'P02'");
  };
  EXPECT_EQ(identities("s.db", "person"), identities("t.db", "person"));
  EXPECT_EQ(identities("s.db", "uid"), identities("t.db", "uid"));
}

}  // namespace
}  // namespace study
