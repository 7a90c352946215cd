#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

using apps::test::run_shell;
using Row = std::map<std::string, std::string>;

class Table2E2e : public ::testing::Test {
 protected:
  apps::test::Ended table2(const std::string& arguments) const {
    return run_shell("env -u DISPLAY VIP_CACHE_DIR= " VIP_BIN_DIR "/vip-bench table2 --backend cpu " +
                     arguments);
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::vector<Row> rows() const {
    std::istringstream lines(base::read_file(path("t2.csv"), 1 << 16));
    const auto cells = [](const std::string& line) {
      std::vector<std::string> out;
      std::istringstream stream(line);
      for (std::string cell; std::getline(stream, cell, ',');) out.push_back(cell);
      return out;
    };
    std::string line;
    std::getline(lines, line);
    const auto head = cells(line);
    std::vector<Row> out;
    while (std::getline(lines, line)) {
      const auto values = cells(line);
      EXPECT_EQ(values.size(), head.size());
      Row row;
      for (std::size_t i = 0; i < head.size(); ++i) row[head[i]] = values[i];
      out.push_back(row);
    }
    return out;
  }
  test::TemporaryFolder folder;
};

TEST_F(Table2E2e, HoldsARowForEachMethodWithItsParts) {
  const auto ended = table2("--scene Faucet --n-star 64 --frames 8 --warm-up 2 --csv " + path("t2.csv") +
                            " --markdown " + path("t2.md") + " --svg " + path("figures"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto table = rows();
  // Ours-TSp has a row with the given tau and one with the measured.
  ASSERT_EQ(table.size(), 6u);
  std::map<std::string, Row> by_method;
  for (const auto& row : table) {
    if (row.at("tau_rule") == "fixed:-6") by_method[row.at("method")] = row;
  }
  ASSERT_EQ(by_method.size(), 5u);
  EXPECT_EQ(table.back().at("method"), "Ours-TSp");
  EXPECT_EQ(table.back().at("tau_rule"), "live");
  EXPECT_EQ(by_method["LoRes"]["particles_mean"], "64");
  EXPECT_EQ(by_method["HiRes"]["particles_mean"], "512");
  EXPECT_EQ(by_method["HiRes"]["speedup"], "1.000");
  for (const char* method : {"LoRes", "HiRes"}) {
    EXPECT_EQ(by_method[method]["ms_saliency"], "0.000") << method;
    EXPECT_EQ(by_method[method]["ms_levels"], "0.000") << method;
    EXPECT_EQ(by_method[method]["ms_activation"], "0.000") << method;
  }
  EXPECT_GT(std::stod(by_method["Ours"]["ms_saliency"]), 0);
  EXPECT_GT(std::stod(by_method["Ours"]["ms_levels"]), 0);
  EXPECT_EQ(by_method["Ours"]["ms_activation"], "0.000");
  EXPECT_GT(std::stod(by_method["Ours-TSp"]["ms_activation"]), 0);
  for (const auto& [method, row] : by_method) EXPECT_GT(std::stod(row.at("ms_solve")), 0) << method;
  for (const auto& [method, row] : by_method) {
    const bool looks = method == "Ours" || method == "Ours-TSp";
    EXPECT_EQ(row.at("picture_by"), looks ? "host" : "none") << method;
  }
  EXPECT_NE(base::read_file(path("figures/table2_speedup.svg"), 1 << 20).find("Ours-TSp"), std::string::npos);
  EXPECT_NE(base::read_file(path("t2.md"), 1 << 20).find("| Faucet |"), std::string::npos);
}

TEST_F(Table2E2e, RefusesUnknownWordsByName) {
  for (const std::string wrong : {"--scene Bathtub", "--tau fixed:nan", "--tau sometimes", "--preset best",
                                  "--n-star 3", "--tau table2 --n-star 64", "--frames 5 --warm-up 5"}) {
    const auto ended = table2(wrong);
    EXPECT_EQ(ended.exit_code, 1) << wrong << ended.out;
    EXPECT_NE(ended.out.find("error"), std::string::npos) << wrong << ended.out;
  }
}

}  // namespace
