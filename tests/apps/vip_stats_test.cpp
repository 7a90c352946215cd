/// The program vip-stats on real databases.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "libstudy/analysis/ptpe/calibration_history.hpp"
#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "libstudy/observer/ptpe_observer.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/pilot_database.hpp"
#include "tests/apps/process.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace {

using study::test::TemporaryFolder;
using testing_pilot::shown_exactly;
using testing_pilot::simulated;
using testing_pilot::write_database;

/// `before`: shell commands that run first; `as`: prefix of the program's command.
apps::test::Ended vip_stats(const std::string& arguments, const std::string& before = "",
                            const std::string& as = "") {
  return apps::test::run_shell(before + as + VIP_BIN_DIR "/vip-stats " + arguments);
}

base::Json read_json(const std::filesystem::path& path) {
  return base::Json::parse(base::read_file(path, 1 << 24));
}

TEST(VipStatsE2e, FitsADatabaseAndWritesAllThreeFiles) {
  const TemporaryFolder folder;
  write_database(folder / "study.db", simulated("ptpe:a=24,b=0.02"));
  const auto before = study::test::bytes_of(folder / "study.db");
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const auto outcome = vip_stats("fit-ptpe " + at("study.db") + " --level 4 --out " + at("fitted.toml") +
                                 " --json " + at("fit.json") + " --svg " + at("heat.svg") + " --seed 3");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  const auto data =
      study::select_task(study::read_tasks(folder / "study.db"), {study::TaskKind::Pilot, {}, {}});
  const auto fit = study::fit_pilot(*data, 4, {2000, 3, 0.95});
  const auto json = read_json(folder / "fit.json");
  EXPECT_EQ(json.at("status"), "ok");
  EXPECT_EQ(json.at("n_participants"), 6);
  EXPECT_EQ(json.at("n_ratings"), 126);
  EXPECT_EQ(json.at("a").get<double>(), fit.main().fit->a);
  EXPECT_EQ(json.at("b_ci")[1].get<double>(), fit.main().spread->b_ci[1]);
  const auto file = sim::read_ptpe_file(folder / "fitted.toml");
  EXPECT_EQ(file.model.a, fit.main().fit->a);
  EXPECT_EQ(file.protocol_sha256, study::test::pilot().sha256);
  EXPECT_TRUE(study::test::bytes_of(folder / "heat.svg").starts_with("<?xml"));
  EXPECT_EQ(study::test::bytes_of(folder / "study.db"), before);
}

TEST(VipStatsE2e, ReportsAllThreeEstimators) {
  const TemporaryFolder folder;
  write_database(folder / "study.db", simulated("ptpe:a=24,b=0.02"));
  const auto json_path = (folder / "fit.json").string();
  const auto outcome = vip_stats("fit-ptpe " + (folder / "study.db").string() + " --json " + json_path);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  const auto json = read_json(json_path);
  std::map<std::string, int> levels;
  std::map<std::string, base::Json> at_level;
  for (const auto& entry : json.at("estimators")) {
    ++levels[entry.at("code")];
    if (entry.at("level") == 4) at_level[entry.at("code")] = entry;
  }
  EXPECT_EQ(at_level.at("direct").at("main"), true);
  EXPECT_EQ(at_level.at("direct").at("a"), json.at("a"));
  for (const char* interval : {"a_ci", "b_ci"}) {
    const auto &direct = at_level.at("direct").at(interval), &contour = at_level.at("contour").at(interval);
    EXPECT_EQ(json.at(interval)[0], std::min(direct[0].get<double>(), contour[0].get<double>()));
    EXPECT_EQ(json.at(interval)[1], std::max(direct[1].get<double>(), contour[1].get<double>()));
  }
  EXPECT_EQ(levels, (std::map<std::string, int>{{"contour", 2}, {"direct", 2}, {"ordinal", 2}}));
  EXPECT_EQ(json.at("bands").size(), 2u * 21);
  EXPECT_EQ(json.at("bands")[0].at("ci"), at_level.at("direct").at("a_ci"));
  EXPECT_TRUE(json.at("lack_of_fit").at("p").is_number());
  for (const char* words : {"direct", "contour (the paper's)", "ordinal mixed", "for the solver",
                            "shape of the scores", "mu(20)", "the band of the curve"})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << outcome.out;
}

TEST(VipStatsE2e, RefusesATooWideIntervalUnlessForced) {
  const TemporaryFolder folder;
  write_database(folder / "study.db", simulated("ptpe:a=24,b=0.02"));
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const std::string fit = "fit-ptpe " + at("study.db") + " --resamples 100 --max-width 0.01 --out " +
                          at("fitted.toml") + " --json " + at("fit.json") + " --svg " + at("heat.svg");
  const auto refused = vip_stats(fit);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.out.find("too wide"), std::string::npos) << refused.out;
  EXPECT_NE(refused.out.find("--force"), std::string::npos) << refused.out;
  for (const char* name : {"fitted.toml", "fitted.toml.history.jsonl", "heat.svg"})
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  EXPECT_EQ(read_json(folder / "fit.json").at("solver_file").at("too_wide"), true);
  ASSERT_EQ(vip_stats(fit + " --force").exit_code, 0);
  EXPECT_NO_THROW(sim::read_ptpe_file(folder / "fitted.toml"));
  const auto record = base::Json::parse(base::read_file(folder / "fitted.toml.history.jsonl", 1 << 20));
  EXPECT_EQ(record.at("forced"), true);
}

std::vector<base::Json> read_lines(const std::filesystem::path& path) {
  std::istringstream text(base::read_file(path, 1 << 20));
  std::vector<base::Json> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(base::Json::parse(line));
  return lines;
}

TEST(VipStatsE2e, KeepsEveryCalibration) {
  const TemporaryFolder folder;
  write_database(folder / "study.db", simulated("ptpe:a=24,b=0.02"));
  const auto toml = folder / "fitted.toml", history = folder / "fitted.toml.history.jsonl";
  const auto fit = [&](const std::string& level) {
    return vip_stats("fit-ptpe " + (folder / "study.db").string() + " --resamples 100 --force --level " +
                     level + " --out " + toml.string());
  };
  ASSERT_EQ(fit("4").exit_code, 0);
  const auto first = study::test::bytes_of(toml);
  ASSERT_EQ(fit("4.5").exit_code, 0);
  auto lines = read_lines(history);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].at("level"), 4);
  EXPECT_EQ(lines[0].at("file"), first);
  EXPECT_EQ(lines[1].at("file"), study::test::bytes_of(toml));
  EXPECT_EQ(lines[1].at("a").get<double>(), sim::read_ptpe_file(toml).model.a);
  // A file changed by hand is recorded before it is replaced.
  base::write_file_atomically(toml, first + "# by hand\n");
  ASSERT_EQ(fit("4").exit_code, 0);
  lines = read_lines(history);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[2].at("found"), true);
  EXPECT_EQ(lines[2].at("file"), first + "# by hand\n");
  // If the record of earlier fits was modified, the command refuses to write anything.
  const auto newest = study::test::bytes_of(toml);
  auto text = study::test::bytes_of(history);
  text[text.find("pilot")] = 'P';
  base::write_file_atomically(history, text);
  const auto refused = fit("4.5");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.out.find("history.jsonl:2"), std::string::npos) << refused.out;
  EXPECT_EQ(study::test::bytes_of(toml), newest);
  EXPECT_EQ(study::test::bytes_of(history), text);
}

TEST(CalibrationHistory, ThatEndsWithinALineIsRefusedWithTheNumberOfThatLine) {
  const TemporaryFolder folder;
  const auto toml = folder / "fitted.toml", history = study::history_of(toml);
  for (int i = 0; i < 2; ++i) study::append_calibration(toml, "a = 1\n", base::Json::object());
  std::string text = study::test::bytes_of(history);
  text.pop_back();
  base::write_file_atomically(history, text);
  try {
    study::append_calibration(toml, "a = 1\n", base::Json::object());
    FAIL();
  } catch (const base::Error& error) {
    EXPECT_NE(std::string(error.what()).find("history.jsonl:2: ends within a line"), std::string::npos)
        << error.what();
  }
}

TEST(VipStatsE2e, FitsAtOneTimeKeepEachOthersCalibrations) {
  const TemporaryFolder folder;
  write_database(folder / "study.db", simulated("ptpe:a=24,b=0.02"));
  const auto toml = folder / "fitted.toml";
  std::vector<std::unique_ptr<apps::test::Process>> fits;
  for (int i = 0; i < 16; ++i)
    fits.push_back(std::make_unique<apps::test::Process>(std::vector<std::string>{
        VIP_BIN_DIR "/vip-stats", "fit-ptpe", (folder / "study.db").string(), "--resamples", "100", "--force",
        "--level", "4." + std::to_string(10 + i), "--out", toml.string()}));
  for (auto& fit : fits) EXPECT_EQ(fit->wait().exit_code, 0);
  std::set<double> levels;
  const auto lines = read_lines(folder / "fitted.toml.history.jsonl");
  for (const auto& line : lines) levels.insert(line.at("level").get<double>());
  EXPECT_EQ(levels.size(), 16u);
  EXPECT_EQ(lines.size(), 16u) << "no file was found that the record does not hold";
  EXPECT_EQ(lines.back().at("file"), study::test::bytes_of(toml)) << "the file in force is the record's last";
}

TEST(VipStatsE2e, SaysWhetherTheIntervalsHoldTheObserversTruth) {
  const TemporaryFolder folder;
  write_database(folder / "study.db", simulated("ptpe:a=24,b=0.02,noise=0.2,participant_sd=0.1"));
  const auto json_path = (folder / "fit.json").string();
  const auto fit = [&](const std::string& truth) {
    return vip_stats("fit-ptpe " + (folder / "study.db").string() + " --json " + json_path + " --truth " +
                     truth);
  };
  const auto far = fit("ptpe:a=40,b=0.2");
  ASSERT_EQ(far.exit_code, 0) << far.out;
  EXPECT_NE(far.out.find("does NOT hold the true 40"), std::string::npos) << far.out;
  EXPECT_EQ(read_json(json_path).at("truth").at("b_ci_holds_it"), false);
  const auto json = read_json(json_path);
  const double a = json.at("a"), b = json.at("b");
  const auto near = fit("ptpe:a=" + std::to_string(a) + ",b=" + std::to_string(b));
  EXPECT_EQ(near.out.find("NOT"), std::string::npos) << near.out;
  EXPECT_EQ(read_json(json_path).at("truth").at("a_ci_holds_it"), true);
  EXPECT_EQ(fit("a=24,b=0.02").exit_code, 1);
}

TEST(VipStatsE2e, SaysPlainlyThatThereIsNoFitAndKeepsOldFiles) {
  const TemporaryFolder folder;
  write_database(folder / "study.db", [](const auto&, const auto&) { return 4; });
  base::write_file_atomically(folder / "fitted.toml", "old");
  const auto outcome = vip_stats("fit-ptpe --db " + (folder / "study.db").string() + " --out " +
                                 (folder / "fitted.toml").string() + " --json " +
                                 (folder / "fit.json").string() + " --svg " + (folder / "heat.svg").string());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("all ratings are equal"), std::string::npos) << outcome.out;
  const auto json = read_json(folder / "fit.json");
  EXPECT_EQ(json.at("status"), "failed");
  EXPECT_EQ(json.at("converged"), false);
  EXPECT_TRUE(json.at("a").is_null());
  EXPECT_EQ(study::test::bytes_of(folder / "fitted.toml"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "heat.svg"));
}

TEST(VipStatsE2e, RefusesWhatIsNoDatabase) {
  const TemporaryFolder folder;
  base::write_file_atomically(folder / "text.db", "participant,rating\n1,4\n");
  for (const char* name : {"missing.db", "text.db"}) {
    const auto path = (folder / name).string();
    const auto outcome = vip_stats("fit-ptpe " + path + " --json " + (folder / "fit.json").string());
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_NE(outcome.out.find(path), std::string::npos) << outcome.out;
    EXPECT_FALSE(std::filesystem::exists(folder / "fit.json"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "missing.db"));
}

TEST(VipStatsE2e, RefusesOutputsThatOverwriteInputOrEachOther) {
  const TemporaryFolder folder;
  base::write_file_atomically(folder / "study.db", "precious");
  const auto path = (folder / "study.db").string();
  EXPECT_EQ(vip_stats("fit-ptpe " + path + " --json " + path).exit_code, 1);
  const auto twice = vip_stats("fit-ptpe " + path + " --json x.json --svg ./x.json");
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_NE(twice.out.find("mend"), std::string::npos) << twice.out;
  EXPECT_EQ(study::test::bytes_of(folder / "study.db"), "precious");
}

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

/// A folder with a finished study that all users may read and none may write.
class LockedStudy {
 public:
  LockedStudy() {
    write_database(folder_ / "study.db", simulated("ptpe:a=24,b=0.02"));
    for (const char* file : {"study.db", "study.db.answers.jsonl"})
      std::filesystem::permissions(folder_ / file, static_cast<std::filesystem::perms>(0444));
    std::filesystem::permissions(folder_.path(), read_only);
  }
  ~LockedStudy() { std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_all); }
  LockedStudy(const LockedStudy&) = delete;
  LockedStudy& operator=(const LockedStudy&) = delete;
  std::string database() const { return (folder_ / "study.db").string(); }
  /// Root may write anywhere, so the program runs as another user.
  static std::string unprivileged() {
    return geteuid() == 0 ? "setpriv --reuid 65534 --regid 65534 --clear-groups " : "";
  }

  static constexpr auto read_only = static_cast<std::filesystem::perms>(0555);

 private:
  TemporaryFolder folder_;
};

TEST(VipStatsE2e, LeavesNothingHalfWrittenAtAFileSizeLimit) {
  const TemporaryFolder folder, out;
  const auto database = folder / "study.db";
  write_database(database, simulated("ptpe:a=24,b=0.02"));
  // A second connection, so that the files that SQLite keeps beside the database exist already and none of
  // them reaches the limit.
  study::sqlite::Connection other(database, study::sqlite::Open::Write);
  other.integer("SELECT count(*) FROM session");
  const auto json = (out / "fit.json").string();
  const auto outcome =
      vip_stats("fit-ptpe " + database.string() + " --resamples 100 --json " + json, "ulimit -f 1; ");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_NE(outcome.out.find(json + ": cannot be written"), std::string::npos) << outcome.out;
  EXPECT_EQ(files_in(out.path()), 0u);
}

TEST(VipStatsE2e, ReadsAndFailsCleanlyInFoldersThatItMayNotWrite) {
  const LockedStudy study;
  const TemporaryFolder out;
  std::filesystem::permissions(out.path(), LockedStudy::read_only);
  const auto file = (out / "fitted.toml").string();
  const std::string fit = "fit-ptpe " + study.database() + " --resamples 100";
  EXPECT_EQ(vip_stats(fit, "", LockedStudy::unprivileged()).exit_code, 0);
  const auto outcome = vip_stats(fit + " --out " + file, "", LockedStudy::unprivileged());
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_NE(outcome.out.find(file), std::string::npos) << outcome.out;
  EXPECT_EQ(files_in(out.path()), 0u);
  std::filesystem::permissions(out.path(), std::filesystem::perms::owner_all);
}

TEST(VipStatsE2e, RefusesAWrongCommandLine) {
  for (const char* arguments : {"fit-ptpe", "fit-ptpe a.db --db b.db", "fit-ptpe a.db --level nan",
                                "fit-ptpe a.db --exclude all", "fit-ptpe a.db --resamples 1", "fit"}) {
    EXPECT_EQ(vip_stats(arguments).exit_code, 2) << arguments;
  }
}

}  // namespace
