/// A sweep's picture errors against the reference, its orders of convergence, and tau of its frame times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/gl/png.hpp"
#include "libstudy/sweep/run/accuracy_page.hpp"
#include "libstudy/sweep/run/budget.hpp"
#include "stats/base/error.hpp"
#include "stats/ptpe/ptpe.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps {
namespace {

using study::sqlite::Open;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

constexpr int side = 32;
constexpr std::size_t pixels = std::size_t{side} * side;

/// A grey picture, darker by `step` in the left half.
std::string picture(int grey, int step = 0) {
  sim::Image out{side, side, {}};
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto value = static_cast<std::uint8_t>(i % side < side / 2 ? grey - step : grey);
    out.rgba.insert(out.rgba.end(), {value, value, value, 255});
  }
  return sim::png_bytes(out, "a picture");
}

std::string half(bool left) {
  std::vector<std::uint8_t> mask(pixels);
  for (std::size_t i = 0; i < pixels; ++i) mask[i] = (i % side < side / 2) == left;
  return study::to_bits(mask);
}

/// Pairs of pictures at 0.1, 0.2, ... s and 1/30 s later.
study::CellRun film(const std::vector<int>& greys, int step = 0, bool masks = false) {
  study::CellRun out;
  out.pixels_per_degree = 5;
  for (std::size_t i = 0; i < greys.size(); ++i) {
    const double time = 0.1 * static_cast<double>(i / 2 + 1) + (i % 2 ? 1.0 / 30 : 0);
    out.pictures.push_back({time, picture(greys[i], step)});
    if (masks && i % 2 == 0) {
      out.pictures.back().fovea = half(true);
      out.pictures.back().salient = half(false);
    }
  }
  return out;
}

double error(const study::PictureScores& scores, std::size_t run, study::PictureError which) {
  return scores.errors[run][static_cast<std::size_t>(which)];
}

TEST(SweepPictures, BitsGiveTheMaskBack) {
  const std::vector<std::uint8_t> mask{1, 0, 0, 1, 1, 0, 1, 0, 1, 1};
  EXPECT_EQ(study::from_bits(study::to_bits(mask), 10), mask);
  EXPECT_TRUE(study::from_bits(study::to_bits(mask), 17).empty());
}

TEST(SweepPictures, ErrorsAreThoseOfTheMetrics) {
  const study::CellRun reference = film({100, 100, 100, 100}, 0, true);
  const study::CellRun shifted = film({110, 110, 110, 110}), stepped = film({100, 100, 100, 100}, 20),
                       restless = film({100, 106, 100, 106});
  const auto scores =
      study::score_pictures({&shifted, &stepped, &restless, &reference}, reference, reference);
  EXPECT_EQ(scores.parting_s, std::numeric_limits<double>::infinity()) << "the twin is the reference itself";
  using enum study::PictureError;
  EXPECT_NEAR(error(scores, 0, Picture), 100 * 10 / 255.0, 1e-9);
  EXPECT_EQ(error(scores, 0, Flicker), 0) << "an error that stays is no flicker";
  EXPECT_GT(error(scores, 0, Flip), 0);
  EXPECT_NEAR(error(scores, 1, Fovea), 100 * 20 / 255.0, 1e-9);
  EXPECT_EQ(error(scores, 1, Salient), 0);
  EXPECT_NEAR(error(scores, 1, Picture), 100 * 20 / std::sqrt(2.0) / 255, 1e-9);
  EXPECT_GT(error(scores, 1, Ssim), error(scores, 0, Ssim)) << "an edge is structure";
  EXPECT_EQ(error(scores, 1, Film), error(scores, 1, Ssim));
  EXPECT_NEAR(error(scores, 2, Flicker), 100 * 6 / 255.0, 1e-9);
  EXPECT_EQ(error(scores, 2, Picture), 0) << "the first of two is compared";
  for (const double value : scores.errors[3]) EXPECT_EQ(value, 0);
}

TEST(SweepPictures, AfterThePartingOnlyTheFilmIsTold) {
  const study::CellRun reference = film({100, 100, 100, 100, 100, 100});
  const study::CellRun twin = film({100, 100, 101, 104, 140, 140});
  const study::CellRun early = film({106, 106, 106, 106, 100, 100}),
                       late = film({100, 100, 106, 106, 160, 160}),
                       usual = film({106, 106, 106, 106, 106, 106});
  // The twin is the reference from a start that differs by one unit in the last place. The median difference
  // of the three runs from the reference is 6 at each instant. The pictures part where the twin differs by at
  // least a third of this median, 2. The twin differs by 1 at 0.2 s, and by 4 at 0.2 s + 1/30 s.
  const auto scores = study::score_pictures({&early, &late, &usual}, reference, twin);
  EXPECT_NEAR(scores.parting_s, 0.2 + 1.0 / 30, 1e-12);
  EXPECT_NEAR(error(scores, 0, study::PictureError::Picture), 100 * 6 / 255.0, 1e-9);
  EXPECT_NEAR(error(scores, 1, study::PictureError::Picture), 100 * std::sqrt((0 + 36) / 2.0) / 255, 1e-9)
      << "without the last instant";
  EXPECT_GT(error(scores, 1, study::PictureError::Film), error(scores, 1, study::PictureError::Ssim));
  // A twin that differs from the first instant on.
  const study::CellRun wild = film({190, 190, 190, 190, 190, 190});
  const auto none = study::score_pictures({&early}, reference, wild);
  EXPECT_NEAR(none.parting_s, 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(error(none, 0, study::PictureError::Flip)));
  EXPECT_FALSE(std::isnan(error(none, 0, study::PictureError::Film)));
}

TEST(SweepPictures, OthersThanTheReferencesAreRefused) {
  const study::CellRun reference = film({100, 100, 100, 100});
  study::CellRun shorter = film({100, 100}), later = reference, damaged = reference;
  later.pictures[1].time_s += 0.01;
  damaged.pictures[2].png.resize(30);
  for (const auto* run : {&shorter, &later, &damaged})
    EXPECT_THROW(study::score_pictures({&reference, run}, reference, reference), base::Error);
}

TEST(SweepPictures, WithoutPicturesNothingIsSaidOfThem) {
  const study::CellRun none;
  const auto scores = study::score_pictures({&none}, none, none);
  EXPECT_TRUE(std::isnan(scores.parting_s));
  for (const double value : scores.errors[0]) EXPECT_TRUE(std::isnan(value));
}

const study::SweepPlan plan{.n_star = 512, .kept = "32x32"};
const study::SweepOrigin origin{"a machine", "0.1.0 abc", "feed"};

/// A run whose front (m) and kinetic energy (J/kg) are larger by `off` than those of the reference, with
/// frames of `ms`.
study::CellRun water(double off, double ms, const study::CellRun& seen) {
  study::CellRun out = seen;
  out.samples.push_back({.time_s = 0.1, .front_m = 5 + off, .kinetic_j_kg = 10 + off});
  out.samples.back().density_error = 0.001;
  for (int frame = 0; frame < 40; ++frame) out.frames.push_back({ms, {}});
  return out;
}

study::StoredCell stored(const sim::SolverSetting& setting, int seed, const study::CellRun& run) {
  return {{setting, seed, plan.seconds, plan.size, plan.kept}, origin, run};
}

/// Cells whose errors are of second order in the particle spacing and of first order in the time step.
std::vector<study::StoredCell> sweep() {
  const auto reference = study::reference_setting("SingleDam", 512);
  const auto usual = sim::usual_setting("SingleDam", sim::MethodKind::HiRes, 512);
  std::vector<study::StoredCell> out{stored(reference, 1, water(0, 99, film({100, 100}, 0, true))),
                                     stored(reference, 2, water(0.001, 99, film({100, 101})))};
  for (const double size : {128.0, 256.0, 512.0, 1024.0}) {
    auto setting = usual;
    setting[sim::SolverKnob::Size] = size;
    const double spacing = std::cbrt(512 / size);
    out.push_back(stored(setting, 1, water(0.1 * spacing * spacing, 25, film({110, 110}))));
  }
  for (const double substeps : {1.0, 2.0, 4.0}) {
    auto setting = usual;
    setting[sim::SolverKnob::Substeps] = substeps;
    out.push_back(stored(setting, 1, water(0.3 / substeps, 50, film({120, 120}))));
  }
  return out;
}

TEST(SweepOrders, AreTheSlopesOfWhatRefiningChanges) {
  const auto list = study::price_list(sweep(), plan, origin, 10);
  ASSERT_EQ(list.orders.size(), 2u);
  EXPECT_NEAR(list.orders[0].order[0], 2, 1e-9);
  EXPECT_NEAR(list.orders[0].order[2], 2, 1e-9);
  EXPECT_TRUE(std::isnan(list.orders[0].order[1])) << "the centre did not move";
  EXPECT_NEAR(list.orders[1].order[0], 1, 1e-9);
  EXPECT_THAT(study::to_markdown(list),
              HasSubstr("HiRes' order in the time step (1.00, 0.50, 0.25): front 1.00, "
                        "centre -, kinetic 1.00"));
  auto part = sweep();
  part.erase(part.begin() + 3);
  EXPECT_EQ(study::price_list(part, plan, origin, 10).orders.size(), 1u) << "one of the sizes was not run";
}

TEST(SweepTau, IsThatOfFramesAsADisplayShowsThem) {
  const auto list = study::price_list(sweep(), plan, origin, 10);
  for (const auto& one : list.settings) {
    const double substeps = one.setting[sim::SolverKnob::Substeps];
    EXPECT_NEAR(one.tau, (substeps > 0 ? 20 : 40) - 23.68, 1e-9) << "25 or 50 ms, without spread";
  }
  auto fast = sweep();
  for (auto& frame : fast[2].run.frames) frame.solve_ms = 1;
  double most = 0;
  for (const auto& one : study::price_list(fast, plan, origin, 10).settings) most = std::max(most, one.tau);
  EXPECT_NEAR(most, 60 - 23.68, 1e-9) << "no frame comes earlier than a 60th of a second";
}

TEST(SweepPictures, StandInTablesPageAndBudget) {
  const auto list = study::price_list(sweep(), plan, origin, 10);
  EXPECT_TRUE(list.pictures());
  EXPECT_THAT(study::to_markdown(list), HasSubstr("| FLIP % |"));
  EXPECT_THAT(study::to_markdown(list), HasSubstr("pictures and its second seed's do not diverge"));
  auto parting = list;
  parting.parting_s = 0.4;
  EXPECT_THAT(study::to_markdown(parting), HasSubstr("diverge 0.40 s after frame 0."))
      << "not all have a gate";
  EXPECT_THAT(figures::to_csv(study::setting_table(list)), HasSubstr("picture_pct,picture_pct_low"));
  const auto page = study::accuracy_page(list, plan);
  for (const char* words : {"Error of flicker", "Error of what is seen (FLIP)", "Compared pictures: 32x32 px",
                            "order in the particle spacing (1.00, 0.79, 0.63, 0.50): front 2.00"})
    EXPECT_THAT(page, HasSubstr(words));
  const auto order = study::within_budget(list.settings, 30, study::SweepError::Picture);
  EXPECT_EQ(order.size(), 4u) << "those of 25 ms";
}

TEST(SweepPictures, ASweepWithoutThemSaysSo) {
  auto cells = sweep();
  auto bare = plan;
  bare.kept.clear();
  for (auto& cell : cells) {
    cell.cell.kept.clear();
    cell.run.pictures.clear();
  }
  const auto list = study::price_list(cells, bare, origin, 10);
  EXPECT_FALSE(list.pictures());
  EXPECT_THAT(study::to_markdown(list), Not(HasSubstr("FLIP")));
  EXPECT_THAT(study::accuracy_page(list, bare), HasSubstr("The sweep kept no pictures"));
  EXPECT_TRUE(study::within_budget(list.settings, 30, study::SweepError::Flip).empty());
  const study::BudgetRequest request{bare, 30, study::SweepError::Flip, 10};
  EXPECT_THAT([&] { study::choose_setting(cells, origin, request, {}, {}); },
              ThrowsMessage<base::Error>(HasSubstr("the sweep kept no pictures")));
  // A plan that keeps pictures does not match cells without them.
  EXPECT_THROW(study::price_list(cells, plan, origin, 10), base::Error);
}

TEST(SweepPictures, MoreSeedsOfFrontsKeepPicturesToo) {
  const auto cells = study::more_seeds_of_fronts(study::price_list(sweep(), plan, origin, 10), plan, 3);
  ASSERT_FALSE(cells.empty());
  for (const auto& cell : cells) EXPECT_EQ(cell.kept, plan.kept);
}

TEST(SweepPictures, AnErrorThatNoRowHasIsSaidToBeUntold) {
  auto cells = sweep();
  for (auto& kept : cells.front().run.pictures) kept.salient.clear();
  const auto list = study::price_list(cells, plan, origin, 10);
  EXPECT_THAT(study::to_markdown(list), HasSubstr("salient_pct: the reference has no large enough part"));
  EXPECT_THAT(study::to_markdown(list), Not(HasSubstr("nan")));
  EXPECT_THAT(study::accuracy_page(list, plan),
              HasSubstr("Not known: the reference has no large enough part"));
  const study::BudgetRequest request{plan, 30, study::SweepError::Salient, 10};
  EXPECT_THAT([&] { study::choose_setting(cells, origin, request, {}, {}); },
              ThrowsMessage<base::Error>(HasSubstr("--error salient: is not known for any setting")));
}

TEST(SweepPictures, WhoAsksForOtherCellsHearsWhichThereAre) {
  auto other = plan;
  other.kept = "64x36";
  EXPECT_THAT([&] { study::price_list(sweep(), other, origin, 10); },
              ThrowsMessage<base::Error>(HasSubstr("compared 64x36; it holds 9 cells of a machine")));
  EXPECT_THAT(
      [&] {
        study::price_list(sweep(), plan, {"another", origin.program, origin.scene_sha256}, 10);
      },
      ThrowsMessage<base::Error>(HasSubstr("of another, program")));
}

TEST(SweepPictures, TheFileGivesThemBack) {
  const ::test::TemporaryFolder folder;
  const auto cell = sweep().front();
  study::SweepFile(folder / "a.db", Open::Create).add(cell);
  const auto found = study::SweepFile(folder / "a.db", Open::Read).cells();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].cell, cell.cell);
  EXPECT_EQ(found[0].run.pixels_per_degree, 5);
  ASSERT_EQ(found[0].run.pictures.size(), 2u);
  EXPECT_EQ(found[0].run.pictures[1].time_s, cell.run.pictures[1].time_s);
  EXPECT_EQ(found[0].run.pictures[0].png, cell.run.pictures[0].png);
  EXPECT_EQ(found[0].run.pictures[0].fovea, cell.run.pictures[0].fovea);
  EXPECT_EQ(found[0].run.pictures[0].salient, cell.run.pictures[0].salient);
  EXPECT_EQ(found[0].run.pictures[1].salient, "");
}

class SweepPicturesE2e : public test::TableTest {};

TEST_F(SweepPicturesE2e, AWholeSweepTellsOfThem) {
  const std::string words =
      "accuracy --quick --n-star 64 --seconds 0.2 --seeds 1 --pictures 64x36 --db " + path("a.db");
  const auto ended = table(words + " --csv " + path("a.csv"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  double least = 1e9, most = 0;
  for (const auto& row : rows("a.csv")) {
    for (const char* error : {"picture_pct", "film_pct", "flicker_pct"})
      EXPECT_GE(std::stod(row.at(error)), 0) << row.at("setting");
    least = std::min(least, std::stod(row.at("film_pct")));
    most = std::max(most, std::stod(row.at("film_pct")));
  }
  EXPECT_GT(most, least) << "settings differ";
  const auto other = table(
      "accuracy --quick --n-star 64 --seconds 0.2 --seeds 1 --table --pictures none --db " + path("a.db"));
  EXPECT_EQ(other.exit_code, 1) << "its cells are others";
  EXPECT_THAT(other.out, HasSubstr("no finished reference"));
  for (const char* wrong : {"10x10", "big"}) {
    const auto refused = table("accuracy --quick --pictures " + std::string(wrong) + " --db " + path("b.db"));
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.out, HasSubstr("--pictures"));
    EXPECT_FALSE(std::filesystem::exists(path("b.db")));
  }
  for (const char* output : {"--csv ", "--prices-csv ", "--markdown ", "--html "}) {
    const auto refused = table(words + " --table " + output + path("a.db"));
    EXPECT_EQ(refused.exit_code, 1) << output;
    EXPECT_THAT(refused.out, HasSubstr("is the database"));
  }
  EXPECT_FALSE(study::SweepFile(path("a.db"), Open::Read).cells().empty()) << "it is as it was";
  EXPECT_THAT(table("accuracy --quick --n-star 64 --seconds 0.125 --list").out,
              HasSubstr("seconds=0.133333 "));
}

}  // namespace
}  // namespace apps
