/// vip-stats power in cells, each some of the studies of one number of people: together they are the whole
/// calculation, and the files with their outcomes (shards) give the result of one run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "libstudy/power/shard.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

study::PowerRequest request_for(const std::string& protocol, std::vector<int> n, int studies,
                                std::vector<std::string> worlds) {
  study::PowerRequest out;
  out.file = protocol;
  out.protocol = study::read_protocol(base::resource(protocol));
  out.n = std::move(n);
  out.studies = studies;
  out.worlds = std::move(worlds);
  return out;
}

/// 220 studies of 24 people by the mixed model, which are more than one cell.
study::PowerRequest by_model() {
  auto out = request_for("protocols/task1.toml", {24}, 220, {"null"});
  out.plan.plan.tests = stats::ScoreTests::Mixed;
  return out;
}
study::PowerRequest pairs() { return request_for("protocols/task2.toml", {8, 10}, 40, {"null", "paper"}); }
study::PowerRequest pilot() { return request_for("protocols/ptpe_pilot.toml", {6, 8}, 12, {}); }

std::set<std::string> keys_of(const study::PowerRequest& request) {
  std::set<std::string> out;
  for (const auto& cell : study::power_cells(request)) out.insert(cell.key);
  return out;
}

TEST(PowerCells, MakeUpTheCalculation) {
  auto request = request_for("protocols/task1.toml", {2, 26, 2000}, 2000, {"null"});
  for (const auto tests : {stats::ScoreTests::Paired, stats::ScoreTests::Mixed}) {
    request.plan.plan.tests = tests;
    std::map<int, int> next;  // next study by n
    for (const auto& cell : study::power_cells(request)) {
      EXPECT_EQ(cell.studies.first, next[cell.n]) << cell.words;
      EXPECT_GT(cell.studies.count, 0);
      next[cell.n] += cell.studies.count;
    }
    EXPECT_EQ(next, (std::map<int, int>{{2, 2000}, {26, 2000}, {2000, 2000}}));
    EXPECT_EQ(keys_of(request).size(), study::power_cells(request).size());
  }
  EXPECT_EQ(study::power_cells(by_model())[1].words, "24 participants, studies 209 to 220");
}

TEST(PowerCells, AreKnownByAllThatTheirStudiesDependOn) {
  const auto usual = keys_of(pairs());
  const auto differs = [&](auto change) {
    auto request = pairs();
    change(request);
    std::vector<std::string> common;
    std::ranges::set_intersection(keys_of(request), usual, std::back_inserter(common));
    return common.empty();
  };
  EXPECT_TRUE(differs([](auto& request) { request.seed = 2; }));
  EXPECT_TRUE(differs([](auto& request) { request.worlds = {"null"}; }));
  EXPECT_TRUE(differs([](auto& request) { request.interval_bias = 1; }));
  EXPECT_TRUE(differs([](auto& request) { request.effect = 0.7; }));
  EXPECT_TRUE(differs([](auto& request) { request.plan.plan.alpha = 0.01; }));
  EXPECT_TRUE(differs([](auto& request) { request.protocol.sha256[0] ^= 1; }));
  EXPECT_TRUE(differs([](auto& request) { request.studies = 41; })) << "a block of 41 is another one";
  EXPECT_FALSE(differs([](auto& request) { request.power = 0.9; }));
  EXPECT_FALSE(differs([](auto& request) { request.n.push_back(12); }));
}

class PowerShards : public ::testing::Test {
 protected:
  /// Writes one file for each cell, from the last cell to the first.
  std::vector<std::filesystem::path> run_apart(const study::PowerRequest& request) const {
    std::vector<std::filesystem::path> out;
    auto cells = study::power_cells(request);
    std::ranges::reverse(cells);
    for (const auto& cell : cells) {
      out.push_back(folder_ / (cell.key + ".json"));
      study::run_cell(request, cell, out.back());
    }
    return out;
  }
  static std::string bytes_of(const std::filesystem::path& file) { return base::read_file(file, 1 << 24); }
  const ::test::TemporaryFolder folder_;
};

TEST_F(PowerShards, GiveWhatOneRunGivesBitForBit) {
  for (const auto& request : {by_model(), pairs(), pilot()}) {
    auto shards = run_apart(request);
    EXPECT_GE(shards.size(), 2u);
    shards.push_back(shards.front());  // one shard twice
    const auto serial = study::power_json(request, study::simulate_studies(request, {0, request.studies}));
    EXPECT_TRUE(study::power_json(request, study::join_shards(request, shards)).dump() == serial.dump())
        << request.file;
  }
}

TEST_F(PowerShards, KeepIntervalsWithoutEnd) {
  const auto request = pilot();
  const auto shards = run_apart(request);
  study::Json shard = study::Json::parse(bytes_of(shards[0]));
  shard["outcomes"][0] = study::Json::parse(R"([true, true, 24.5, "Inf", "-Inf", "Inf", 0.02, null, 0, 1])");
  shard["outcomes_sha256"] = base::sha256_hex(shard["outcomes"].dump());
  base::write_file_atomically(shards[0], shard.dump());
  const auto joined = std::get<study::PilotOutcomes>(study::join_shards(request, shards));
  const auto& read = joined[1][0];  // the last cell's shard is the first file
  EXPECT_EQ(read.a.value, 24.5);
  EXPECT_TRUE(std::isinf(read.a.ci[1]) && std::isinf(read.a.ci[0]) && read.a.ci[0] < 0);
  EXPECT_TRUE(std::isnan(read.b.se));
  EXPECT_EQ(read.b.ci[1], 1);
}

TEST_F(PowerShards, OfOtherStudiesAreRefusedByName) {
  const auto request = pairs();
  const auto shards = run_apart(request);
  const auto refused = [&](const study::PowerRequest& other, const std::string& what) {
    EXPECT_THAT([&] { study::join_shards(other, shards); },
                ThrowsMessage<base::Error>(AllOf(HasSubstr(shards[0].string()), HasSubstr(what))));
  };
  auto other = request;
  other.seed = 9;
  refused(other, "another seed (1, here 9)");
  other = request;
  other.plan.plan.alpha = 0.01;
  refused(other, "another plan");
  other = request;
  other.worlds = {"paper", "null"};
  refused(other, "another worlds");
  refused(pilot(), "another protocol");
  other = request;
  other.n = {8};
  refused(other, "holds \"10 participants, studies 1 to 40\", which is no cell");
  study::Json older = study::Json::parse(bytes_of(shards[0]));
  older["studies"]["program"] = "0.0.9 feed";
  base::write_file_atomically(shards[0], older.dump());
  refused(request, "another program (\"0.0.9 feed\"");
}

TEST_F(PowerShards, MissingCellsAreNamed) {
  const auto request = pairs();
  auto shards = run_apart(request);
  const auto missing = study::power_cells(request)[0];
  shards.pop_back();
  EXPECT_THAT([&] { study::join_shards(request, shards); },
              ThrowsMessage<base::Error>(HasSubstr("1 of 2 cells are missing: " + missing.key +
                                                   " (8 participants, studies 1 to 40)")));
}

TEST_F(PowerShards, WhatIsNoneIsRefusedAndLeftAsItIs) {
  const auto request = pairs();
  const auto cell = study::power_cells(request)[0];
  const auto file = folder_ / "cell.json";
  study::run_cell(request, cell, file);
  const std::string sound = bytes_of(file);
  const auto refused = [&](const std::string& bytes, const char* why) {
    base::write_file_atomically(file, bytes);
    EXPECT_THAT([&] { study::join_shards(request, {file}); }, ThrowsMessage<base::Error>(HasSubstr(why)));
    EXPECT_EQ(bytes_of(file), bytes);
  };
  refused("", "not a shard");
  refused("{\"schema\":\"vip-power/1\"}", "not a shard");
  refused(sound.substr(0, sound.size() / 2), "damaged or cut short");
  refused(sound.substr(0, 60), "damaged or cut short");
  auto text = sound;
  refused(text.replace(text.find("shard/1"), 7, "shard/2"), "newer program");
  study::Json fewer = study::Json::parse(sound);
  study::Json& figures = fewer["outcomes"][0][1];
  figures = std::vector<study::Json>(figures.begin() + 1, figures.end());
  refused(fewer.dump(), "damaged or cut short");
  fewer["outcomes_sha256"] = base::sha256_hex(fewer["outcomes"].dump());
  refused(fewer.dump(), "damaged or cut short");
  fewer = study::Json::parse(sound);
  fewer["outcomes"][0][0][0] = "many";
  fewer["outcomes_sha256"] = base::sha256_hex(fewer["outcomes"].dump());
  refused(fewer.dump(), "damaged or cut short");
  fewer = study::Json::parse(sound);
  fewer["outcomes"][0][0][0] = fewer["outcomes"][0][0][0].get<int>() + 1;
  refused(fewer.dump(), "damaged or cut short");
}

TEST_F(PowerShards, ACellThatIsThereIsNotRunAgainAndNothingElseIsOverwritten) {
  const auto request = pairs();
  const auto cells = study::power_cells(request);
  const auto file = folder_ / "cell.json";
  study::run_cell(request, cells[0], file);
  const std::string marked = bytes_of(file) + " ";
  base::write_file_atomically(file, marked);
  study::run_cell(request, cells[0], file);
  EXPECT_EQ(bytes_of(file), marked);
  EXPECT_THAT([&] { study::run_cell(request, cells[1], file); },
              ThrowsMessage<base::Error>(HasSubstr(cells[1].key)));
  EXPECT_EQ(bytes_of(file), marked);
  base::write_file_atomically(file, "mine");
  EXPECT_THROW(study::run_cell(request, cells[0], file), base::Error);
  EXPECT_EQ(bytes_of(file), "mine");
}

using PowerShardsE2e = PowerShards;

TEST_F(PowerShardsE2e, ThroughTheCommandLine) {
  const std::string power = VIP_BIN_DIR "/vip-stats power ";
  const std::string plan = "protocols/task2.toml --n 8:10:2 --studies 40 --world null";
  const auto in = [&](const char* name) { return (folder_ / name).string(); };
  const auto serial = test::run_program(
      {"/bin/sh", "-c", power + plan + " --json " + in("s.json") + " --csv " + in("s.csv")});
  ASSERT_EQ(serial.exit_code, 0) << serial.err;
  std::istringstream lines(test::run_shell(power + plan + " --list").out);
  std::string shards;
  int number = 0;
  for (std::string key, words; lines >> key && std::getline(lines, words);) {
    const std::string shard = in(("shard" + std::to_string(number++)).c_str());
    const auto ended = test::run_shell(power + plan + " --cell " + key + " --out " + shard);
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
    shards = " " + shard + shards;
  }
  EXPECT_EQ(number, 2);
  const auto merged = test::run_program(
      {"/bin/sh", "-c",
       power + "merge " + plan + " --json " + in("m.json") + " --csv " + in("m.csv") + shards});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(merged.out, serial.out);
  EXPECT_EQ(bytes_of(in("m.json")), bytes_of(in("s.json")));
  EXPECT_EQ(bytes_of(in("m.csv")), bytes_of(in("s.csv")));
  for (const auto& [words, place] : std::vector<std::pair<std::string, std::string>>{
           {plan + " --cell 0123 --out " + in("x.json"), "--cell 0123: is no cell"},
           {"merge " + plan + " --json " + in("x.json") + " --csv " + in("x.json") + shards, "--json"},
           {"merge " + plan + " --json " + in("x.json") + " " + in("shard0"), "1 of 2 cells are missing"}}) {
    const auto ended = test::run_shell(power + words);
    EXPECT_EQ(ended.exit_code, 1) << ended.out;
    EXPECT_THAT(ended.out, AllOf(HasSubstr(place), HasSubstr("mend:")));
    EXPECT_FALSE(std::filesystem::exists(in("x.json"))) << words;
  }
  const auto over = test::run_shell(power + "merge " + plan + " --json " + in("shard0") + shards);
  EXPECT_EQ(over.exit_code, 1);
  EXPECT_THAT(over.out, HasSubstr("is a shard that is to be joined"));
  EXPECT_THAT(bytes_of(in("shard0")), ::testing::StartsWith("{\"")) << "it is as it was";
  EXPECT_THAT(bytes_of(in("shard0")), HasSubstr("outcomes"));
  for (const std::string& words : {plan + " --cell 0123", plan + " --out " + in("x.json"),
                                   std::string("--list"), plan + " --list --json " + in("x.json")}) {
    EXPECT_EQ(test::run_shell(power + words).exit_code, 2) << words;
  }
}

TEST(PowerPilotE2e, SaysWhoseAnswersItSimulates) {
  const std::string power = VIP_BIN_DIR "/vip-stats power protocols/ptpe_pilot.toml --n 8 --studies 4";
  const auto usual = test::run_shell(power).out;
  EXPECT_THAT(usual, HasSubstr("true a = 23.68 frames/s, true b = 0.02 s/frame"));
  EXPECT_THAT(usual, ::testing::Not(HasSubstr("precision reached"))) << "no precision was asked for";
  const auto other = test::run_shell(power + " --observer ptpe:a=30,b=0.01,noise=2 --precision-a 3").out;
  EXPECT_THAT(other, HasSubstr("true a = 30 frames/s, true b = 0.01 s/frame"));
  EXPECT_THAT(other, HasSubstr("SD of the answers 2 "));
  EXPECT_EQ(other.find("precision reached"), other.rfind("precision reached")) << "of a alone";
  EXPECT_NE(other.find("precision reached"), std::string::npos);
}

}  // namespace
}  // namespace apps
