#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "stats/base/file.hpp"
#include "tests/apps/table_test_support.hpp"

namespace {

using apps::test::Row;

class Table2E2e : public apps::test::TableTest {
 protected:
  apps::test::Ended table2(const std::string& arguments) const { return table("table2 " + arguments); }
};

TEST_F(Table2E2e, HoldsARowForEachMethodWithItsParts) {
  const auto ended = table2("--scene SingleDam --n-star 64 --frames 4 --warm-up 1 --csv " + path("t2.csv") +
                            " --markdown " + path("t2.md") + " --svg " + path("figures"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto table = rows("t2.csv");
  // Ours-TSp has two rows: one with a fixed tau, like every method, and one with tau from the measured frame
  // times.
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
    EXPECT_EQ(by_method[method]["splits"], "0.0") << method;
  }
  EXPECT_EQ(by_method["Ours"]["solved"], "1.000");
  EXPECT_LT(std::stod(by_method["Ours-TSp"]["solved"]), 1) << "some particles rest";
  EXPECT_GT(std::stod(by_method["Ours"]["merges"]), 0);
  EXPECT_GT(std::stod(by_method["Ours"]["ms_saliency"]), 0);
  EXPECT_GT(std::stod(by_method["Ours"]["ms_levels"]), 0);
  EXPECT_EQ(by_method["Ours"]["ms_activation"], "0.000");
  EXPECT_GT(std::stod(by_method["Ours-TSp"]["ms_activation"]), 0);
  for (const auto& [method, row] : by_method) EXPECT_GT(std::stod(row.at("ms_solve")), 0) << method;
  for (const auto& [method, row] : by_method) {
    const bool looks = method == "Ours" || method == "Ours-TSp";
    EXPECT_EQ(row.at("picture_by"), looks ? "host" : "none") << method;
  }
  // The speed-up is the ratio of the steps' wall times, which the table rounds to three decimals.
  const double hires_ms = std::stod(by_method["HiRes"]["ms_step_mean"]);
  for (const auto& row : table) {
    const double ms = std::stod(row.at("ms_step_mean")), speedup = std::stod(row.at("speedup"));
    EXPECT_NEAR(speedup, hires_ms / ms, 1e-3 + speedup * (6e-4 / ms + 6e-4 / hires_ms)) << row.at("method");
    EXPECT_GE(std::stod(row.at("ms_step_p99")), ms) << "the longest of three";
    EXPECT_GT(ms, std::stod(row.at("ms_read_back"))) << "the picture's way is part of a step";
  }
  EXPECT_NE(base::read_file(path("figures/table2_speedup.svg"), 1 << 20).find("Ours-TSp"), std::string::npos);
  EXPECT_NE(base::read_file(path("t2.md"), 1 << 20).find("| SingleDam |"), std::string::npos);
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
