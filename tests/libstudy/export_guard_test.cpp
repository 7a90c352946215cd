/// Words of people in exports: spreadsheets do not take them for formulas, the original words can be
/// recovered, and only the owner may read the files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <random>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::vector<std::string> hostile{"=HYPERLINK(\"http://x\",\"y\")",
                                       "+1+1",
                                       "-2+3|cmd",
                                       "@SUM(1)",
                                       "\t=1+1",
                                       "\r=1+1",
                                       "\n=1+1",
                                       "'=1+1",
                                       "''@x",
                                       "\uFF1D1+1",
                                       "=a,\"b\"\r\nc",
                                       "-3.5"};

/// True if a spreadsheet would take the field for a formula.
bool is_formula(const std::string& field) {
  for (const char* sign : {"=", "+", "-", "@", "\t", "\r", "\n", "\uFF1D", "\uFF0B", "\uFF0D", "\uFF20"}) {
    if (field.starts_with(sign)) return true;
  }
  return false;
}

/// Recovers the original words by the rule that the data dictionary of an export states.
std::string read_back(const std::string& field) {
  const std::size_t first = field.find_first_not_of('\'');
  const bool guarded = first != 0 && first != std::string::npos && is_formula(field.substr(first));
  return guarded ? field.substr(1) : field;
}

/// Fields of all lines, by RFC 4180.
std::vector<std::string> fields_of(const fs::path& path) {
  const std::string text = test::bytes_of(path);
  std::vector<std::string> fields{""};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"')
      fields.back() += text[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == ',' || c == '\n'))
      fields.emplace_back();
    else if (quoted || c != '\r')
      fields.back() += c;
  }
  return fields;
}

bool is_number(const std::string& field) {
  char* end = nullptr;
  std::strtod(field.c_str(), &end);
  return !field.empty() && *end == '\0';
}

/// A session with all texts of `hostile` as notes, and with formulas as its station and as the reason of each
/// exclusion.
void make_hostile_study(const fs::path& path) {
  Store store(path, sqlite::Open::Create);
  RunPlan plan = test::run_plan(test::pairs(), {"P01"});
  plan.sessions.at(0).station = "=station()";
  store.add_run(plan);
  const auto session = store.open_runs().at(0).sessions.at(0);
  for (const std::string& words : hostile) store.note(session.id, {}, words);
  for (const OpenUnit& unit : session.units) {
    if (unit.trial) store.exclude_trial(session.id, unit.trial_id, "@excluded");
  }
}

TEST(FormulaGuard, AnyTextReadsBackAndNoneIsAFormula) {
  const std::vector<std::string> letters{"'",  "=", "+", "-",  "@", "\t",    "\r",
                                         "\n", "a", "1", "\"", ",", "\uFF0B"};
  std::mt19937 random(4);
  int guarded = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (std::size_t n = random() % 6; n > 0; --n) text += letters[random() % letters.size()];
    const std::string field = formula_guarded(text);
    EXPECT_FALSE(is_formula(field)) << text;
    EXPECT_EQ(read_back(field), text);
    guarded += field != text ? 1 : 0;
  }
  EXPECT_GT(guarded, 10000);
  EXPECT_EQ(formula_guarded("it's = fine"), "it's = fine");
}

TEST(FormulaGuard, NoFieldOfAnExportIsAFormulaButAllWordsAreThere) {
  const test::TemporaryFolder folder;
  make_hostile_study(folder / "study.db");
  export_csv(folder / "study.db", folder / "out", {.words = true});
  std::vector<std::string> all;
  for (const auto& entry : fs::directory_iterator(folder / "out")) {
    if (entry.path().extension() != ".csv") continue;
    for (const std::string& field : fields_of(entry.path())) {
      EXPECT_TRUE(!is_formula(field) || is_number(field)) << entry.path() << ": " << field;
      all.push_back(read_back(field));
    }
  }
  for (const std::string& words : hostile) EXPECT_THAT(all, ::testing::Contains(words));
  EXPECT_THAT(all, ::testing::Contains("=station()"));
  EXPECT_THAT(all, ::testing::Contains("@excluded"));
  EXPECT_THAT(test::bytes_of(folder / "out" / "notes.csv"), HasSubstr(",\"'-3.5\"\r\n"));
  EXPECT_THAT(test::bytes_of(folder / "out" / "dictionary.csv"),
              HasSubstr("\r\n(all),(all),TEXT,\"text that"));
}

TEST(FormulaGuard, NumbersStayNumbers) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", sqlite::Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  sqlite::Connection(folder / "study.db", sqlite::Open::Write)
      .execute("UPDATE trial SET schedule_seed = -5 WHERE trial_id = 1");
  export_csv(folder / "study.db", folder / "out");
  EXPECT_THAT(fields_of(folder / "out" / "trials.csv"), ::testing::Contains("-5"));
}

TEST(FormulaGuard, PublicExportsAreGuardedAndSaySo) {
  const test::TemporaryFolder folder;
  make_hostile_study(folder / "study.db");
  export_bids(folder / "study.db", folder / "bids");
  export_psych_ds(folder / "study.db", folder / "psych");
  EXPECT_THAT(test::bytes_of(folder / "bids" / "sub-P01" / "sub-P01_sessions.tsv"),
              HasSubstr("\t'=station()\t"));
  bool found = false;
  for (const auto& entry : fs::directory_iterator(folder / "psych" / "data")) {
    const std::string text = test::bytes_of(entry.path());
    found = found || text.find(",\"'=station()\",") != std::string::npos;
    EXPECT_EQ(text.find(",=station()"), std::string::npos);
  }
  EXPECT_TRUE(found);
  for (const char* name : {"bids", "psych"})
    EXPECT_THAT(test::bytes_of(folder / name / "README.md"), HasSubstr(formula_guard_meaning));
}

TEST(ExportRights, CsvIsTheOwnersAloneAndPublicExportsAreAsTheUmaskSays) {
  const test::TemporaryFolder folder;
  make_hostile_study(folder / "study.db");
  const mode_t before = ::umask(022);
  export_csv(folder / "study.db", folder / "csv", {.words = true});
  export_bids(folder / "study.db", folder / "bids");
  ::umask(before);
  const auto rights = [](const fs::path& path) { return fs::status(path).permissions(); };
  EXPECT_EQ(rights(folder / "csv"), fs::perms(0700));
  for (const auto& entry : fs::directory_iterator(folder / "csv"))
    EXPECT_EQ(rights(entry.path()), fs::perms(0600)) << entry.path();
  EXPECT_EQ(rights(folder / "bids"), fs::perms(0755));
  EXPECT_EQ(rights(folder / "bids" / "participants.tsv"), fs::perms(0644));
}

}  // namespace
}  // namespace study
