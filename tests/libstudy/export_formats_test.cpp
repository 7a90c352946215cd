/// BIDS and Psych-DS: the rules of their validators, and no lost data.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/export_labels.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* secret = "my own words";

/// The first participant answers a page, a practice pair and the remarks. The participants' codes have
/// characters that labels of BIDS must not have.
fs::path make_study(const test::TemporaryFolder& folder) {
  const fs::path path = folder / "study.db";
  Store store(path, sqlite::Open::Create);
  RunPlan run = test::run_plan(test::pairs(), {"P-01", "Q_01"});
  run.sessions[0].refresh_hz = 90;
  store.add_run(run);
  const auto sessions = store.open_runs().at(0).sessions;
  const OpenSession& session = sessions.at(0);
  const KeptAnswer games{"games", {test::score(1), 2}};
  store.answer(session.id, session.units.at(0), 0, {&games, 1}, true, 1);
  const OpenUnit& pair = session.units.at(1);
  const int attempt = test::show(store, session, pair, 10);
  const std::vector<KeptAnswer> kept{{"preference", {test::score(2), 1.25}}, {"ease", {test::score(5), 3}}};
  store.answer(session.id, pair, attempt, kept, true, 1);
  const KeptAnswer words{"remarks", {test::words(secret), 1}};
  store.answer(session.id, session.units.back(), 0, {&words, 1}, true, 1);
  // An earlier version accepted codes that differ only in punctuation, here P-01 and P_01.
  sqlite::Connection(path, sqlite::Open::Write)
      .execute("UPDATE session SET participant = 'P_01' WHERE participant = 'Q_01'; DELETE FROM label");
  fs::remove(path.string() + ".answers.jsonl");  // the journal has the earlier codes and labels
  return path;
}

std::vector<std::string> split(const std::string& line, char by) {
  std::vector<std::string> parts;
  std::istringstream stream(line);
  for (std::string part; std::getline(stream, part, by);) parts.push_back(part);
  return parts;
}

std::vector<std::vector<std::string>> read_table(const fs::path& path, char by) {
  std::vector<std::vector<std::string>> rows;
  std::string text = test::bytes_of(path);
  text.erase(std::remove(text.begin(), text.end(), '\r'), text.end());
  for (const std::string& line : split(text, '\n')) rows.push_back(split(line + by + "end", by));
  for (auto& row : rows) row.pop_back();
  return rows;
}

base::Json read_json(const fs::path& path) { return base::Json::parse(test::bytes_of(path)); }

std::set<std::string> files_below(const fs::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.insert(fs::relative(entry.path(), folder).string());
  }
  return files;
}

bool holds(const fs::path& folder, const std::string& text) {
  for (const std::string& name : files_below(folder)) {
    if (test::bytes_of(folder / name).find(text) != std::string::npos) return true;
  }
  return false;
}

TEST(ExportBids, FilesAndTheirNamesAreThoseOfTheStandard) {
  const test::TemporaryFolder folder;
  export_bids(make_study(folder), folder / "bids");
  EXPECT_THAT(files_below(folder / "bids"),
              ElementsAre("README.md", "code/export.sha256", "dataset_description.json", "participants.json",
                          "participants.tsv", "phenotype/about.json", "phenotype/about.tsv",
                          "sub-P01/ses-pairsv1/beh/sub-P01_ses-pairsv1_task-pairs_events.json",
                          "sub-P01/ses-pairsv1/beh/sub-P01_ses-pairsv1_task-pairs_events.tsv",
                          "sub-P01/sub-P01_sessions.json", "sub-P01/sub-P01_sessions.tsv",
                          "sub-P01x2/ses-pairsv1/beh/sub-P01x2_ses-pairsv1_task-pairs_events.json",
                          "sub-P01x2/ses-pairsv1/beh/sub-P01x2_ses-pairsv1_task-pairs_events.tsv",
                          "sub-P01x2/sub-P01x2_sessions.json", "sub-P01x2/sub-P01x2_sessions.tsv"));
  const auto description = read_json(folder / "bids" / "dataset_description.json");
  EXPECT_EQ(description["Name"], "pairs 1.0") << "of the study, not of the folder";
  EXPECT_EQ(description["BIDSVersion"], "1.11.0");
  EXPECT_EQ(description["GeneratedBy"][0]["Name"], "vip-study");
}

// Readers must not take data of simulated participants for data of people.
TEST(ExportBids, SimulatedParticipantsAreNamedSuch) {
  const test::TemporaryFolder folder;
  const fs::path study = make_study(folder);
  const std::string all = "For 2 of 2 participants a simulated observer answered";
  export_bids(study, folder / "bids");
  EXPECT_THAT(test::bytes_of(folder / "bids/README.md"), HasSubstr(all));
  EXPECT_THAT(read_json(folder / "bids/dataset_description.json").dump(), HasSubstr(all));
  EXPECT_EQ(read_table(folder / "bids/participants.tsv", '\t').at(1).at(2), "1");
  export_psych_ds(study, folder / "psych");
  EXPECT_THAT(test::bytes_of(folder / "psych/README.md"), HasSubstr(all));
  EXPECT_THAT(read_json(folder / "psych/dataset_description.json")["description"].dump(), HasSubstr(all));
  EXPECT_EQ(read_json(folder / "psych/dataset_description.json")["name"], "pairs 1.0");
  sqlite::Connection(study, sqlite::Open::Write).execute("UPDATE session SET observer = NULL");
  export_bids(study, folder / "people");
  EXPECT_EQ(test::bytes_of(folder / "people/README.md").find("simulated"), std::string::npos);
  EXPECT_EQ(read_table(folder / "people/participants.tsv", '\t').at(1).at(2), "0");
}

TEST(ExportBids, EveryTableIsFullAndEveryColumnIsDescribed) {
  const test::TemporaryFolder folder;
  export_bids(make_study(folder), folder / "bids");
  int tables = 0;
  for (const std::string& name : files_below(folder / "bids")) {
    if (!name.ends_with(".tsv")) continue;
    SCOPED_TRACE(name);
    ++tables;
    const auto rows = read_table(folder / "bids" / name, '\t');
    const std::set<std::string> columns(rows[0].begin(), rows[0].end());
    EXPECT_EQ(columns.size(), rows[0].size());
    for (const auto& row : rows) {
      EXPECT_EQ(row.size(), rows[0].size());
      EXPECT_EQ(std::count(row.begin(), row.end(), ""), 0);
    }
    const std::string sidecar = name.substr(0, name.size() - 3) + "json";
    const auto json = read_json(folder / "bids" / sidecar);
    for (const std::string& column : rows[0]) {
      if (column == "participant_id" || column == "session_id") continue;
      EXPECT_TRUE(json.contains(column) && json[column].contains("Description")) << column;
    }
  }
  EXPECT_EQ(tables, 6);
}

TEST(ExportBids, AQuestionNamedAsAColumnHasOneOfItsOwn) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  const auto text = std::regex_replace(test::pairs().text, std::regex("\\bease\\b"), "effects");
  {
    Store store(path, sqlite::Open::Create);
    store.add_run(test::run_plan(parse_protocol(text, "pairs.toml"), {"P01"}));
    const auto sessions = store.open_runs().at(0).sessions;
    const OpenUnit& pair = sessions.at(0).units.at(1);
    const KeptAnswer kept{"effects", {test::score(5), 3}};
    store.answer(sessions.at(0).id, pair, test::show(store, sessions.at(0), pair, 10), {&kept, 1}, true, 1);
  }
  export_bids(path, folder / "bids");
  const fs::path stem = folder / "bids/sub-P01/ses-pairsv1/beh/sub-P01_ses-pairsv1_task-pairs_events";
  const auto head = read_table(stem.string() + ".tsv", '\t').at(0);
  EXPECT_EQ(std::count(head.begin(), head.end(), "effects"), 1);
  EXPECT_EQ(std::count(head.begin(), head.end(), "answer_effects"), 1);
  const auto json = read_json(stem.string() + ".json");
  EXPECT_THAT(json["effects"]["Description"].get<std::string>(), HasSubstr("level of the factor effects"));
}

TEST(ExportBids, EventsTellWhatWasShownAndAnswered) {
  const test::TemporaryFolder folder;
  export_bids(make_study(folder), folder / "bids");
  const fs::path stem = folder / "bids/sub-P01/ses-pairsv1/beh/sub-P01_ses-pairsv1_task-pairs_events";
  const auto rows = read_table(stem.string() + ".tsv", '\t');
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0][0], "onset");
  EXPECT_EQ(rows[0][1], "duration");
  EXPECT_EQ(rows[0][2], "trial_type");
  EXPECT_EQ(rows[1][0], "0");
  EXPECT_EQ(rows[1][1], "0.2");
  EXPECT_EQ(rows[1][2], "practice");
  EXPECT_EQ(std::stod(rows[2][0]), 0.2);  // the second stimulus begins when the first one ends
  std::map<std::string, std::string> first, second;
  for (std::size_t i = 0; i < rows[0].size(); ++i) {
    first[rows[0][i]] = rows[1][i];
    second[rows[0][i]] = rows[2][i];
  }
  EXPECT_NE(first["method"], second["method"]);
  EXPECT_EQ(first["preference"], "n/a");
  EXPECT_EQ(second["preference"], "2");
  EXPECT_EQ(second["preference_response_time"], "1.25");
  EXPECT_EQ(second["ease"], "5");
  EXPECT_EQ(second["mean_fps"], "49.5");
  const auto json = read_json(stem.string() + ".json");
  EXPECT_EQ(json["preference"]["Levels"]["2"], "second");
  EXPECT_EQ(json["StimulusPresentation"]["ScreenRefreshRate"], 90);
  const auto about = read_table(folder / "bids" / "phenotype" / "about.tsv", '\t');
  EXPECT_THAT(about.at(0), ElementsAre("participant_id", "pairsv1_about_games"));
  EXPECT_THAT(about.at(1), ElementsAre("sub-P01", "1"));
  EXPECT_THAT(about.at(2), ElementsAre("sub-P01x2", "n/a"));
  EXPECT_FALSE(holds(folder / "bids", secret));
}

TEST(ExportPsychDs, NamesAndColumnsAreThoseOfTheStandard) {
  const test::TemporaryFolder folder;
  export_psych_ds(make_study(folder), folder / "psych");
  const auto description = read_json(folder / "psych" / "dataset_description.json");
  EXPECT_EQ(description["@type"], "Dataset");
  EXPECT_THAT(description["@context"].get<std::string>(), HasSubstr("schema.org"));
  EXPECT_FALSE(description["name"].get<std::string>().empty());
  EXPECT_FALSE(description["description"].get<std::string>().empty());
  std::set<std::string> measured;
  for (const auto& variable : description["variableMeasured"]) {
    EXPECT_FALSE(variable["description"].get<std::string>().empty()) << variable;
    EXPECT_TRUE(measured.insert(variable["name"]).second) << variable;
  }
  const std::regex name_of_data("data/([a-z]+-[A-Za-z0-9]+)(_[a-z]+-[A-Za-z0-9]+)*_data\\.csv");
  int tables = 0;
  for (const std::string& name : files_below(folder / "psych")) {
    if (!name.ends_with(".csv")) continue;
    SCOPED_TRACE(name);
    ++tables;
    EXPECT_TRUE(std::regex_match(name, name_of_data));
    const auto rows = read_table(folder / "psych" / name, ',');
    for (const std::string& column : rows[0]) EXPECT_TRUE(measured.contains(column)) << column;
  }
  EXPECT_EQ(tables, 4);
  EXPECT_FALSE(holds(folder / "psych", secret));
}

TEST(ExportPsychDs, EachSessionHasItsRatingsAndItsPages) {
  const test::TemporaryFolder folder;
  const auto files = export_psych_ds(make_study(folder), folder / "psych").files;
  ASSERT_EQ(files.size(), 4u);
  EXPECT_EQ(files[0].name, "data/study-pairs_subject-P01_session-pairsv1_data.csv");
  EXPECT_EQ(files[0].rows, 8);  // four pairs, two questions each
  EXPECT_EQ(files[1].rows, 2);
  EXPECT_EQ(files[2].rows, 8);
  EXPECT_EQ(files[3].rows, 0);
}

TEST(ExportFormats, ReplaceTheirOwnAndNothingElse) {
  const test::TemporaryFolder folder;
  const fs::path database = make_study(folder);
  export_bids(database, folder / "bids");
  export_psych_ds(database, folder / "psych");
  EXPECT_EQ(export_bids(database, folder / "bids").files.size(), 6u);
  EXPECT_EQ(export_psych_ds(database, folder / "psych").files.size(), 4u);
  EXPECT_THAT([&] { export_bids(database, folder / "psych"); },
              ThrowsMessage<base::Error>(HasSubstr("is not an earlier export")));
  EXPECT_THAT([&] { export_psych_ds(database, folder / "bids"); },
              ThrowsMessage<base::Error>(HasSubstr("is not an earlier export")));
}

TEST(ExportLabels, AreLettersAndDigitsAndDistinct) {
  Labels labels;
  EXPECT_EQ(labels.of("P-01"), "P01");
  EXPECT_EQ(labels.of("P_01"), "P01x2");
  EXPECT_EQ(labels.of("P01"), "P01x3");
  EXPECT_EQ(labels.of("P-01"), "P01");
  EXPECT_EQ(labels.of("--"), "x");
}

}  // namespace
}  // namespace study
