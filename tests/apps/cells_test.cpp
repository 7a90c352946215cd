/// vip-stats fit-ptpe and compare-models in cells: together they are the whole calculation, and the files
/// with their outcomes (shards) give the result of one run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "libstudy/analysis/ptpe/fit_shards.hpp"
#include "libstudy/analysis/rivals/rival_shards.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/pilot_database.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/rival_study.hpp"
#include "tests/apps/simulated_pilot.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Paths = std::vector<std::filesystem::path>;

std::string bytes_of(const std::filesystem::path& file) { return base::read_file(file, 1 << 26); }

/// JSON without the time at which it was made.
std::string timeless(const std::string& json) {
  std::istringstream lines(json);
  std::string out;
  for (std::string line; std::getline(lines, line);)
    if (line.find("\"date_utc\"") == std::string::npos) out += line + "\n";
  return out;
}

/// 60 people and 1700 resamples, which are more than one cell.
study::FitRequest request() {
  study::TaskStudy read;
  read.protocols.push_back(testing_pilot::simulated_pilot("ptpe:a=24,b=0.02,noise=1", 60, 5));
  study::FitRequest out;
  out.data = *study::collect_task(read, {study::TaskKind::Pilot, {}, {}});
  out.bootstrap = {1700, 3, 0.95};
  return out;
}

/// The shards of all cells, from the last cell to the first.
struct Shards {
  const ::test::TemporaryFolder folder;
  Paths files;
  Shards() {
    auto cells = study::fit_cells(request());
    std::ranges::reverse(cells);
    for (const auto& cell : cells) {
      files.push_back(folder / (cell.key + ".json"));
      study::run_fit_cell(request(), cell, files.back());
    }
  }
};

class FitCells : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { made_ = std::make_unique<Shards>(); }
  static void TearDownTestSuite() { made_.reset(); }
  static const Paths& shards() { return made_->files; }
  static std::unique_ptr<Shards> made_;
  const ::test::TemporaryFolder folder_;
};
std::unique_ptr<Shards> FitCells::made_;

TEST_F(FitCells, GiveTheFitOfOneRunBitForBit) {
  const auto one = request();
  EXPECT_EQ(study::fit_cells(one).size(), 2u);
  EXPECT_EQ(study::fit_cells(one)[1].words, "resamples 1667 to 1700");
  auto files = shards();
  files.push_back(files.front());  // one shard twice
  const auto drawn = study::join_fit_shards(one, files);
  const auto serial = study::fit_pilot(one.data, one.level, one.bootstrap, one.rules);
  const auto joined = study::fit_pilot(one.data, one.level, one.bootstrap, one.rules, &drawn);
  ASSERT_TRUE(serial.chosen().contour.spread);
  EXPECT_EQ(serial.chosen().contour.spread->resamples, 1700);
  EXPECT_EQ(timeless(study::fit_json(joined).dump(1)), timeless(study::fit_json(serial).dump(1)));
  auto wrong = drawn;
  wrong[0].pop_back();
  EXPECT_THROW(study::fit_pilot(one.data, one.level, one.bootstrap, one.rules, &wrong),
               std::invalid_argument);
  wrong.pop_back();
  EXPECT_THROW(study::fit_pilot(one.data, one.level, one.bootstrap, one.rules, &wrong),
               std::invalid_argument);
}

TEST_F(FitCells, AreKnownByAllThatTheirResamplesDependOn) {
  const auto keys = [](const study::FitRequest& of) {
    std::set<std::string> out;
    for (const auto& cell : study::fit_cells(of)) out.insert(cell.key);
    return out;
  };
  const auto usual = keys(request());
  const auto differs = [&](auto change) {
    auto other = request();
    change(other);
    std::vector<std::string> common;
    std::ranges::set_intersection(keys(other), usual, std::back_inserter(common));
    return common.empty();
  };
  EXPECT_TRUE(differs([](auto& of) { of.bootstrap.seed = 4; }));
  EXPECT_TRUE(differs([](auto& of) { of.bootstrap.confidence = 0.9; }));
  EXPECT_TRUE(differs([](auto& of) { of.level = 4.5; }));
  EXPECT_TRUE(differs([](auto& of) { of.rules.model_drift = true; }));
  EXPECT_TRUE(differs([](auto& of) { of.data.ratings[7].score += 1; }));
  EXPECT_TRUE(differs([](auto& of) { of.data.ratings[7].realised_mu += 1e-12; }));
  EXPECT_FALSE(differs([](auto& of) { of.bootstrap.resamples = 5000; }));
}

TEST_F(FitCells, OfOtherDataOptionsAndProgramsAreRefusedByName) {
  const auto refused = [&](const study::FitRequest& of, const Paths& files, const std::string& what) {
    EXPECT_THAT([&] { study::join_fit_shards(of, files); },
                ThrowsMessage<base::Error>(AllOf(HasSubstr(files[0].string()), HasSubstr(what))));
  };
  auto other = request();
  other.bootstrap.seed = 9;
  refused(other, shards(), "holds resamples with another seed (3, here 9)");
  other = request();
  other.data.ratings[0].score -= 1;
  refused(other, shards(), "holds resamples with another data");
  other = request();
  other.bootstrap.resamples = 1666;
  refused(other, shards(), "holds \"resamples 1667 to 1700\", which is no cell of this calculation");

  const std::string sound = bytes_of(shards()[0]);
  const auto file = folder_ / "shard.json";
  const auto changed = [&](const std::string& bytes, const std::string& what) {
    base::write_file_atomically(file, bytes);
    refused(request(), {file}, what);
    EXPECT_EQ(bytes_of(file), bytes) << "it is left as it is";
  };
  auto json = study::Json::parse(sound);
  json["resamples"]["program"] = "0.0.9 feed";
  changed(json.dump(), "another program (\"0.0.9 feed\"");
  changed("", "is not a shard of vip-stats fit-ptpe");
  changed(sound.substr(0, sound.size() / 2), "is damaged or cut short");
  auto text = sound;
  text.replace(text.find("shard/1"), 7, "shard/2");
  changed(text, "newer program");
  text = sound;
  char& digit = text[text.rfind('.') + 2];
  digit = digit == '1' ? '2' : '1';
  changed(text, "is damaged or cut short");
}

TEST_F(FitCells, MissingCellsAreNamedAndNothingIsOverwritten) {
  const auto cells = study::fit_cells(request());
  EXPECT_THAT([&] { study::join_fit_shards(request(), {shards()[0]}); },
              ThrowsMessage<base::Error>(
                  HasSubstr("1 of 2 cells are missing: " + cells[0].key + " (resamples 1 to 1666)")));
  const auto file = folder_ / "cell.json";
  const std::string marked = bytes_of(shards()[0]) + " ";
  base::write_file_atomically(file, marked);
  study::run_fit_cell(request(), cells[1], file);  // it is there
  EXPECT_THAT([&] { study::run_fit_cell(request(), cells[0], file); },
              ThrowsMessage<base::Error>(HasSubstr("exists already and does not hold cell " + cells[0].key)));
  EXPECT_EQ(bytes_of(file), marked);
}

/// A command of vip-stats on a database, in one run and in cells.
class CellsE2e : public ::testing::Test {
 protected:
  test::Ended stats(const std::string& line) const {
    return test::run_shell("OMP_NUM_THREADS=1 " VIP_BIN_DIR "/vip-stats " + line);
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  /// Runs each cell and writes the names of the shards into shards.txt. Returns their number.
  int run_cells(const std::string& command) const {
    std::istringstream lines(stats(command + " --list").out);
    std::ofstream names(at("shards.txt"));
    int number = 0;
    for (std::string key, words; lines >> key && std::getline(lines, words); ++number) {
      const auto ended = stats(command + " --cell " + key + " --out " + at(key));
      EXPECT_EQ(ended.exit_code, 0) << ended.out;
      names << at(key) << "\n";
    }
    return number;
  }

  /// Expects that the joined shards give the output and the JSON of one run.
  void expect_serial(const std::string& command, const std::string& options) const {
    const auto serial = stats(command + " " + options + " --json " + at("serial.json"));
    ASSERT_EQ(serial.exit_code, 0) << serial.out;
    const auto merged = stats(command + " merge --db " + options + " --json " + at("merged.json") +
                              " --shards-in " + at("shards.txt"));
    ASSERT_EQ(merged.exit_code, 0) << merged.out;
    EXPECT_EQ(merged.out, serial.out);
    EXPECT_EQ(timeless(bytes_of(at("merged.json"))), timeless(bytes_of(at("serial.json"))));
  }

  void expect_refused(const std::string& line, int exit_code, const std::string& what) const {
    const auto ended = stats(line);
    EXPECT_EQ(ended.exit_code, exit_code) << ended.out;
    EXPECT_THAT(ended.out, HasSubstr(what)) << line;
  }

  const ::test::TemporaryFolder folder_;
};

TEST_F(CellsE2e, OfAFitThroughTheCommandLine) {
  testing_pilot::write_database(folder_ / "pilot.db", testing_pilot::simulated("ptpe:a=24,b=0.02,noise=1"));
  const std::string pilot = at("pilot.db") + " --resamples 200";
  ASSERT_EQ(run_cells("fit-ptpe " + pilot), 1);
  expect_serial("fit-ptpe", pilot);
  expect_refused("fit-ptpe merge " + pilot, 2, "shards is required");
  expect_refused("fit-ptpe " + pilot + " --cell 0123 --out " + at("x"), 1, "--cell 0123: is no cell");
  expect_refused("fit-ptpe merge " + pilot + " --seed 2 --shards-in " + at("shards.txt"), 1,
                 "another seed (1, here 2)");
  expect_refused(
      "fit-ptpe merge " + pilot + " --shards-in " + at("shards.txt") + " --json " + at("shards.txt"), 1,
      "holds the names of the shards");
  expect_refused("fit-ptpe merge --resamples 200", 2, "database or --db is required");
  expect_refused("fit-ptpe " + pilot + " --cell 0123", 2, "--out");
  expect_refused("fit-ptpe " + pilot + " --list --json " + at("x"), 2, "--json");
  expect_refused("fit-ptpe " + pilot + " --list --out " + at("x"), 2, "--out");
  const auto shard = bytes_of(at("shards.txt")).substr(0, at("shards.txt").size() + 6);
  const auto name = shard.substr(0, shard.find('\n'));
  expect_refused("fit-ptpe merge " + pilot + " " + name + " --json " + name, 1,
                 "is a shard that is to be joined");
  EXPECT_FALSE(std::filesystem::exists(at("x")));
}

TEST_F(CellsE2e, OfAComparisonThroughTheCommandLine) {
  rival_study::write(folder_ / "pilot.db", 8, [](int person, const study::TimingPredictors& timing) {
    const double place = 2.2 * (timing[6] - 2) + 0.3 * (person % 3);
    return std::clamp(static_cast<int>(std::lround(3 + place)), 1, 7);
  });
  const std::string pilot = at("pilot.db") + " --models longest,mean_rate --folds 4";
  ASSERT_EQ(run_cells("compare-models " + pilot), 4) << "two models, nothing and free";
  expect_serial("compare-models", pilot);
  EXPECT_THAT(bytes_of(at(bytes_of(at("shards.txt")).substr(at("").size(), 16))),
              HasSubstr("\"longest without each of groups 1 to 4 of 4\""));
  expect_refused("compare-models merge " + pilot + " --seed 2 --shards-in " + at("shards.txt"), 1,
                 "holds fits with another seed (1, here 2)");
  expect_refused("compare-models " + pilot + " --out " + at("x"), 2, "--cell");
}

}  // namespace
}  // namespace apps
