/// vip-study import as a user runs it, on studies in the layouts of PsychoPy, jsPsych and UXF.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "libstudy/store/import/mapping.hpp"
#include "libstudy/store/import/source_table.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/process.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const std::string sources = VIP_TEST_DIR "/libstudy/fixtures/import/";
const std::string terms = " --sharing refused --consent 'forms in the lab'";

apps::test::Ended vip_study(const std::string& arguments) {
  return apps::test::run_shell(VIP_BIN_DIR "/vip-study " + arguments);
}
apps::test::Ended vip_stats(const std::string& arguments) {
  return apps::test::run_shell(VIP_BIN_DIR "/vip-stats " + arguments);
}

apps::test::Ended import_from(const std::string& source, const std::string& mapping, const fs::path& database,
                              const std::string& more = terms) {
  return vip_study("import " + source + " --protocol ptpe_pilot --mapping " + mapping + " --db " +
                   database.string() + more);
}

base::Json fit_of(const fs::path& database, const fs::path& json) {
  const auto fit = vip_stats("fit-ptpe " + database.string() + " --resamples 100 --json " + json.string());
  EXPECT_EQ(fit.exit_code, 0) << fit.out;
  return base::Json::parse(base::read_file(json, 1 << 24));
}

}  // namespace

TEST(VipStudyImportE2e, StudiesOfThreeToolsAreFittedAndReported) {
  const study::test::TemporaryFolder folder;
  const std::string hashes[] = {"psychopy/P01_ptpe_2026-03-02_14h05.12.345.csv", "jspsych/data.csv",
                                "uxf/ptpe/P01/S001/trial_results.csv"};
  const std::string tools[] = {"PsychoPy", "jsPsych", "UXF"};
  for (std::size_t i = 0; const std::string name : {"psychopy", "jspsych", "uxf"}) {
    SCOPED_TRACE(name);
    const fs::path database = folder / (name + ".db");
    const auto done = import_from(sources + name, name, database);
    ASSERT_EQ(done.exit_code, 0) << done.out;
    EXPECT_THAT(done.out, HasSubstr("6 sessions of 6 people from " + tools[i] + ", 126 trials, 126 answers"));
    EXPECT_THAT(done.out,
                HasSubstr("frames of 0 showings; of 0 only the rates that the source states; of 126 not"));

    // The scores were made with a = 24, b = 0.02.
    const base::Json fit = fit_of(database, folder / (name + ".json"));
    EXPECT_NEAR(fit.at("a").get<double>(), 24, 2.5);
    EXPECT_NEAR(fit.at("b").get<double>(), 0.02, 0.008);
    EXPECT_EQ(fit.at("n_ratings").get<int>(), 126);
    EXPECT_EQ(fit.at("used").at("by_verdict").dump(), R"({"not recorded":126})");
    EXPECT_TRUE(fit.at("used").at("by_grade").empty());
    EXPECT_THAT(fit.at("flags").dump(), HasSubstr("timing_not_recorded"));
    EXPECT_THAT(fit.at("imported").dump(), HasSubstr(base::sha256_of_file(sources + hashes[i])));

    const auto status = vip_study("status --db " + database.string());
    EXPECT_THAT(status.out, HasSubstr("imported from " + tools[i] + ", SHA-256 of the source " +
                                      base::sha256_of_file(sources + hashes[i])));
    EXPECT_THAT(status.out, HasSubstr("21 showings: timing not recorded"));
    EXPECT_THAT(status.out, HasSubstr("data not shared"));

    const fs::path page = folder / (name + ".html");
    const auto report = vip_stats("report " + database.string() + " --html " + page.string() + " --json " +
                                  (folder / "results.json").string());
    ASSERT_EQ(report.exit_code, 0) << report.out;
    const std::string text = base::read_file(page, 1 << 26);
    EXPECT_THAT(text, HasSubstr("were recorded elsewhere, by " + tools[i]));
    EXPECT_THAT(text, HasSubstr("Mean: "));
    EXPECT_THAT(text, Not(HasSubstr("Realised mean")));
    EXPECT_THAT(text, HasSubstr("no frame was recorded: when they were shown is not known"));
    const base::Json results = base::Json::parse(base::read_file(folder / "results.json", 1 << 26));
    for (const base::Json& cell : results.at("timing")) {
      EXPECT_EQ(cell.at("pass").get<int>(), 0);
      EXPECT_EQ(cell.at("not_recorded").get<int>(), cell.at("showings").get<int>());
      EXPECT_TRUE(cell.at("realised_mean_fps").is_null() && cell.at("late_frames").is_null());
    }
    ++i;
  }
}

TEST(VipStudyImportE2e, TheWayBackGivesTheSameFit) {
  const study::test::TemporaryFolder folder;
  const auto run = vip_study("run ptpe_pilot --db " + (folder / "ours.db").string() +
                             " --observer ptpe:a=24,b=0.02 --participants 4 --seed 3");
  ASSERT_EQ(run.exit_code, 0) << run.out;
  ASSERT_EQ(vip_study("export --db " + (folder / "ours.db").string() + " --csv " + (folder / "csv").string())
                .exit_code,
            0);
  const auto back = import_from((folder / "csv").string(), "vip_study", folder / "back.db");
  ASSERT_EQ(back.exit_code, 0) << back.out;
  EXPECT_THAT(back.out, HasSubstr("of 84 only the rates that the source states; of 0 not recorded"));
  const base::Json ours = fit_of(folder / "ours.db", folder / "ours.json");
  const base::Json theirs = fit_of(folder / "back.db", folder / "back.json");
  for (const char* key : {"status",
                          "level",
                          "a",
                          "b",
                          "a_ci",
                          "b_ci",
                          "a_se",
                          "b_se",
                          "n_participants",
                          "n_ratings",
                          "n_settings",
                          "doubts",
                          "relative_half_width",
                          "level5",
                          "estimators",
                          "form",
                          "raters",
                          "lack_of_fit",
                          "bands",
                          "means",
                          "cells",
                          "protocol",
                          "question",
                          "simulated_participants"}) {
    ASSERT_TRUE(ours.contains(key)) << key;
    EXPECT_EQ(ours.at(key).dump(), theirs.at(key).dump()) << key;
  }
  EXPECT_EQ(theirs.at("used").at("by_verdict").dump(), R"({"not recorded":84})");
  EXPECT_THAT(theirs.at("flags").dump(), HasSubstr("timing_stated"));
  EXPECT_THAT(theirs.at("flags").dump(), HasSubstr("4 participants simulated"));
}

TEST(VipStudyImportE2e, JsonGivesTheFitOfTheCsv) {
  const study::test::TemporaryFolder folder;
  ASSERT_EQ(import_from(sources + "jspsych", "jspsych", folder / "csv.db").exit_code, 0);
  const auto json = import_from(sources + "jspsych_json", "jspsych", folder / "json.db");
  ASSERT_EQ(json.exit_code, 0) << json.out;
  EXPECT_THAT(json.out, HasSubstr("6 sessions of 6 people from jsPsych, 126 trials, 126 answers"));
  EXPECT_THAT(json.out, Not(HasSubstr("test data")));
  const base::Json ours = fit_of(folder / "csv.db", folder / "csv.json");
  const base::Json theirs = fit_of(folder / "json.db", folder / "fit.json");
  for (const char* key : {"a", "b", "a_ci", "b_ci", "n_ratings", "means", "cells", "lack_of_fit"})
    EXPECT_EQ(ours.at(key).dump(), theirs.at(key).dump()) << key;

  const auto shorter =
      import_from(sources + "jspsych", "jspsych", folder / "short.db", terms + " --trial-seconds 5");
  ASSERT_EQ(shorter.exit_code, 0) << shorter.out;
  EXPECT_THAT(shorter.out, HasSubstr("test data: 6 of 6 sessions, as --trial-seconds changes the protocol"));
  EXPECT_THAT(vip_study("status --db " + (folder / "short.db").string()).out, HasSubstr(", test data"));
}

TEST(VipStudyImportE2e, TheWayBackOfPairsGivesTheSameChoices) {
  const study::test::TemporaryFolder folder;
  const std::string ours = (folder / "ours.db").string(), back = (folder / "back.db").string();
  ASSERT_EQ(
      vip_study("run task2 --db " + ours + " --observer random --participants 3 --seed 3 --trial-seconds 1")
          .exit_code,
      0);
  ASSERT_EQ(vip_study("export --db " + ours + " --csv " + (folder / "csv").string()).exit_code, 0);
  const auto done =
      vip_study("import " + (folder / "csv").string() + " --protocol task2 --mapping vip_study_pairs --db " +
                back + terms + " --trial-seconds 1");
  ASSERT_EQ(done.exit_code, 0) << done.out;
  EXPECT_THAT(done.out, HasSubstr("3 sessions of 3 people from vip-study, 30 trials, 30 answers"));
  const auto scale = [&](const std::string& database, const char* name) {
    const std::string json = (folder / name).string();
    const auto ended = vip_stats("scale " + database + " --prior normal --json " + json);
    EXPECT_EQ(ended.exit_code, 0) << ended.out;
    return base::Json::parse(base::read_file(json, 1 << 24));
  };
  EXPECT_EQ(scale(ours, "a.json").at("scales").dump(), scale(back, "b.json").at("scales").dump());
  EXPECT_THAT(vip_study("status --db " + back).out,
              HasSubstr("20 showings: frame rates as the source states them"));
}

TEST(VipStudyImportE2e, ImportsOnceAndAllOrNothing) {
  const study::test::TemporaryFolder folder;
  const fs::path database = folder / "s.db";
  const auto silent = import_from(sources + "jspsych", "jspsych", database, "");
  EXPECT_EQ(silent.exit_code, 1);
  EXPECT_THAT(silent.out, HasSubstr("does not say whether these data may stand in public exports"));
  const auto unsaid = import_from(sources + "jspsych", "jspsych", database, " --sharing refused");
  EXPECT_EQ(unsaid.exit_code, 1);
  EXPECT_THAT(unsaid.out, HasSubstr("does not say where the participants' consent is recorded"));

  std::string text = base::read_file(sources + "jspsych/data.csv", 1 << 20);
  const auto last = text.rfind("\"50\",\"");
  std::ofstream(folder / "wrong.csv", std::ios::binary) << text.replace(last, 4, "\"51\"");
  const auto wrong = import_from((folder / "wrong.csv").string(), "jspsych", database);
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.out,
              testing::ContainsRegex("wrong.csv:[0-9]+: mean_fps \"51\".* is no cell of protocol"));
  EXPECT_FALSE(fs::exists(database));

  ASSERT_EQ(import_from(sources + "jspsych", "jspsych", database).exit_code, 0);
  const auto again = import_from(sources + "jspsych", "jspsych", database);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.out, HasSubstr("holds the source of participant P01 already"));
  const auto other = import_from(sources + "uxf", "uxf", database);
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.out, HasSubstr("whether it is the same person is not known"));
  EXPECT_THAT(vip_study("status --db " + database.string()).out, HasSubstr("6 sessions, 126 of 126"));

  // Merged, the six people of either study stay apart; a second copy of one study adds nobody.
  ASSERT_EQ(import_from(sources + "uxf", "uxf", folder / "uxf.db").exit_code, 0);
  const auto merged = vip_study("merge " + database.string() + " " + (folder / "uxf.db").string() +
                                " --into " + (folder / "all.db").string());
  EXPECT_EQ(merged.exit_code, 0) << merged.out;
  EXPECT_THAT(merged.out, HasSubstr("12 sessions"));
}

TEST(VipStudyImportE2e, PublicExportsHoldOnlyWhatTheMappingAllows) {
  const study::test::TemporaryFolder folder;
  ASSERT_EQ(import_from(sources + "psychopy", "psychopy", folder / "kept.db").exit_code, 0);
  const auto kept =
      vip_study("export --db " + (folder / "kept.db").string() + " --bids " + (folder / "b").string());
  EXPECT_EQ(kept.exit_code, 0) << kept.out;
  EXPECT_FALSE(fs::exists(folder / "b/sub-P01"));

  ASSERT_EQ(
      import_from(sources + "psychopy", "psychopy", folder / "open.db", " --sharing allowed --consent forms")
          .exit_code,
      0);
  const auto open = vip_study("export --db " + (folder / "open.db").string() + " --bids " +
                              (folder / "c").string() + " --psych-ds " + (folder / "d").string());
  EXPECT_EQ(open.exit_code, 0) << open.out;
  const std::string sessions = base::read_file(folder / "c/sub-P01/sub-P01_sessions.tsv", 1 << 20);
  EXPECT_THAT(sessions,
              HasSubstr("PsychoPy\t" +
                        base::sha256_of_file(sources + "psychopy/P01_ptpe_2026-03-02_14h05.12.345.csv")));
  EXPECT_THAT(base::read_file(folder / "c/README.md", 1 << 20),
              HasSubstr("6 sessions were recorded by PsychoPy and imported."));
  EXPECT_THAT(base::read_file(folder / "d/dataset_description.json", 1 << 24),
              HasSubstr("6 sessions were recorded by PsychoPy and imported."));
}

TEST(VipStudyImport, AChoiceNamesTheFirstAndThenTheSecondByTheSameKey) {
  const study::test::TemporaryFolder folder;
  const auto mapping_of = [&](const std::string& first, const std::string& second) {
    const std::string text =
        "format = 1\ntool = \"x\"\nrows_in_order = true\n[columns]\nperson = \"who\"\n[columns.first]\n"
        "mean_fps = \"lf\"\nsd_fps = \"ls\"\nfactors = {sharp = \"lq\"}\n[columns.second]\nmean_fps = "
        "\"rf\"\n"
        "sd_fps = \"rs\"\nfactors = {sharp = \"rq\"}\n[[answer]]\nquestion = \"q\"\ncolumn = \"c\"\n"
        "choice_of = [\"" +
        first + "\", \"" + second + "\"]\n";
    std::ofstream(folder / "m.toml") << text;
    return study::read_mapping(folder / "m.toml");
  };
  for (const auto& [one, other] : {std::pair("lf", "rf"), {"ls", "rs"}, {"lq", "rq"}, {"a.png", "b.png"}})
    EXPECT_NO_THROW(mapping_of(one, other)) << one;
  const auto refused = [&](const char* first, const char* second, const char* words) {
    EXPECT_THAT([&] { mapping_of(first, second); }, testing::ThrowsMessage<base::Error>(HasSubstr(words)));
  };
  refused("rf", "lf", "names rf first, which is a column of [columns.second]");
  refused("rf", "b.png", "names rf first");
  refused("a.png", "lq", "names lq second, which is a column of [columns.first]");
  refused("lf", "rs", "names lf and rs, which do not hold the same of both stimuli");
  refused("lq", "rf", "which do not hold the same");
  refused("lf", "b.png", "which do not hold the same");
}

TEST(VipStudyImport, BrokenJsonIsRefusedWithItsPlace) {
  const study::test::TemporaryFolder folder;
  const auto refused = [&](const std::string& text, const std::string& words, const std::string& mend) {
    std::ofstream(folder / "t.json") << text;
    EXPECT_THAT([&] { study::SourceTable table(folder / "t.json"); },
                testing::ThrowsMessage<base::Error>(testing::AllOf(
                    HasSubstr("t.json" + words), HasSubstr(mend), Not(HasSubstr("json.exception")))))
        << text;
  };
  const std::string whole = ": is no whole JSON text: ";
  refused("", whole + "it ends too early", "export it again: the file is empty");
  refused("[{\"n\": 1},\n {\"n\": ", whole + "it ends too early, at line 2, column", "the file is cut short");
  refused("[{\"n\": 1},\n {\"who\": \"P0", whole + "it ends too early, at line 2, column", "is cut short");
  refused("[{\"n\": 1}]\n[]", whole + "it goes on behind its end, at line 2, column 1", "export it again");
  refused("[{\"n\" 1}]", whole + "it has a mistake, at line 1, column", "export it again");
  refused("[{\"n\": \"P\xE9\"}]", whole + "it has bytes that are not UTF-8, at line 1", "export it again");
  refused("[{\"n\": 1}, {\"n\": 1, \"n\": 2}]", ": entry 2: has the key \"n\" twice", "which value holds");
  refused("[[1], 2, {\"a\": {\"q\": 1, \"\\u0071\": 2}}]", ": entry 3: has the key \"q\" twice", "correct");
}

TEST(VipStudyImportE2e, AKeyThatAnAnswerGivesTwiceIsRefused) {
  const study::test::TemporaryFolder folder;
  std::ofstream(folder / "m.toml")
      << "format = 1\ntool = \"x\"\nrows_in_order = true\nonly_person = \"P01\"\n[columns]\nmean_fps = "
         "\"m\"\nsd_fps = \"s\"\n[[answer]]\nquestion = \"satisfaction\"\ncolumn = \"a\"\nkey = \"q\"\n";
  std::ofstream(folder / "t.json") << R"([{"m": 10, "s": 0, "a": "{\"q\": 2, \"q\": 5}"}])";
  std::ofstream(folder / "t.csv") << "m,s,a\n10,0,\"{\"\"q\"\": 2, \"\"q\"\": 5}\"\n";
  for (const auto& [name, place] : {std::pair("t.json", "t.json: entry 1"), {"t.csv", "t.csv:2"}}) {
    const auto done = import_from((folder / name), (folder / "m.toml"), folder / "x.db");
    EXPECT_EQ(done.exit_code, 1);
    EXPECT_THAT(done.out, HasSubstr(place + std::string(", column a: ")));
    EXPECT_THAT(done.out, HasSubstr("has the key \"q\" twice in one object"));
    EXPECT_FALSE(fs::exists(folder / "x.db"));
  }
}
