#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "libsim/gl/png.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/table_test_support.hpp"

namespace {

using apps::test::Row;

class Table1E2e : public apps::test::TableTest {
 protected:
  apps::test::Ended table1(const std::string& arguments) const { return table("table1 " + arguments); }
};

TEST_F(Table1E2e, HoldsARowForEachMethodAndMetric) {
  const auto ended = table1(
      "--scene SingleDam --n-star 128 --checkpoints 1 --gazes 2 --repeats 1 --frames-after 2 --cumul-frames 8"
      " --film-starts 2 --size 400x225 --csv " +
      path("t1.csv") + " --markdown " + path("t1.md") + " --svg " + path("figures") + " --pictures " +
      path("pictures"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  std::map<std::string, std::map<std::string, Row>> table;
  for (const auto& row : rows("t1.csv")) table[row.at("method")][row.at("metric")] = row;
  ASSERT_EQ(table.size(), 5u);
  for (const auto& [method, metrics] : table) {
    ASSERT_EQ(metrics.size(), 8u) << method;
    for (const auto& [name, row] : metrics) {
      EXPECT_EQ(std::stoi(row.at("cells")) + std::stoi(row.at("equal")) + std::stoi(row.at("skipped")), 2)
          << method << ' ' << name << ": two gaze points, or two starts of the film";
    }
    EXPECT_EQ(metrics.at("psnr_overall").at("pixels"), "90000");
    // The masks are made from HiRes and are the same for all methods.
    for (const char* mask : {"psnr_fov", "psnr_salient"}) {
      EXPECT_EQ(metrics.at(mask).at("pixels"), table["HiRes"][mask]["pixels"]) << method;
      EXPECT_EQ(metrics.at(mask).at("skipped"), "0") << method;
    }
    EXPECT_LE(std::stod(metrics.at("ssim_cumul").at("mean")), 1) << method;
    if (method == "HiRes") continue;  // compared with itself, so hardly anything flickers
    EXPECT_GT(std::stod(metrics.at("flicker_periphery").at("mean")), 0) << method;
    EXPECT_NE(metrics.at("flicker_periphery").at("mean"), metrics.at("flicker").at("mean")) << method;
  }
  // HiRes is compared with HiRes from a start that differs by an ulp. In two frames this changes a picture
  // less than coarse particles do.
  const auto floor_db = table["HiRes"]["psnr_overall"]["mean"];
  EXPECT_GT(floor_db == "inf" ? INFINITY : std::stod(floor_db),
            std::stod(table["LoRes"]["psnr_overall"]["mean"]));
  EXPECT_GT(std::stod(table["HiRes"]["ssim_static"]["mean"]),
            std::stod(table["LoRes"]["ssim_static"]["mean"]));
  std::map<std::string, std::string> verdicts;
  for (const auto& row : rows("t1_paired.csv")) {
    verdicts[row.at("metric") + " " + row.at("difference")] = row.at("verdict");
    if (row.at("metric") != "psnr_overall" || row.at("difference") != "Ours - LoRes") continue;
    EXPECT_NEAR(
        std::stod(row.at("mean")),
        std::stod(table["Ours"]["psnr_overall"]["mean"]) - std::stod(table["LoRes"]["psnr_overall"]["mean"]),
        2e-3);
  }
  for (const char* gated : {"psnr_salient Ours - FovFluid", "psnr_overall FovFluid - LoRes",
                            "ssim_static Ours - FovFluid", "psnr_fov Ours - FovFluid"})
    EXPECT_TRUE(verdicts[gated] == "holds" || verdicts[gated] == "broken") << gated << verdicts[gated];
  EXPECT_EQ(verdicts["psnr_salient Ours-TSp - Ours"], "-");
  EXPECT_NE(base::read_file(path("figures/table1_psnr_salient.svg"), 1 << 20).find("Ours-TSp"),
            std::string::npos);
  EXPECT_NE(base::read_file(path("t1.md"), 1 << 20).find("HiRes (floor)"), std::string::npos);
  const auto sheet = sim::read_png(path("pictures/SingleDam_128_tuned_f060.png"));
  EXPECT_EQ(sheet.width, 5 * 400);
  EXPECT_EQ(sheet.height, 2 * 225);
}

TEST_F(Table1E2e, HiResEqualsItselfFromTheSameStart) {
  const auto ended = table1(
      "--scene Faucet --n-star 64 --checkpoints 1 --gazes 1 --repeats 1 --frames-after 2 --cumul-frames 2"
      " --size 160x90 --unperturbed --csv " +
      path("t1.csv"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  std::map<std::string, Row> floor;
  for (const auto& row : rows("t1.csv")) {
    if (row.at("method") == "HiRes") floor[row.at("metric")] = row;
  }
  for (const char* metric : {"psnr_overall", "psnr_fluid"}) {
    EXPECT_EQ(floor[metric]["mean"], "inf") << metric;
    EXPECT_EQ(floor[metric]["equal"], "1") << metric;
  }
  EXPECT_EQ(floor["ssim_static"]["mean"], "1.00000");
  EXPECT_EQ(floor["ssim_cumul"]["mean"], "1.00000");
  EXPECT_EQ(floor["flicker"]["mean"], "0.000");
  EXPECT_EQ(floor["psnr_fov"]["skipped"], "1") << "a fovea of fewer than 1000 px";
}

TEST_F(Table1E2e, RefusesUnknownWordsByName) {
  for (const std::string wrong :
       {"--scene Bathtub", "--checkpoints none", "--checkpoints 0", "--gazes 9", "--size 3x3",
        "--tau fixed:nan", "--preset best", "--n-star 3", "--tau table2 --n-star 64"}) {
    const auto ended = table1(wrong);
    EXPECT_EQ(ended.exit_code, 1) << wrong << ended.out;
    EXPECT_NE(ended.out.find("error"), std::string::npos) << wrong << ended.out;
  }
}

}  // namespace
