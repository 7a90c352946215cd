#include "stats/ptpe/placement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "stats/figures/svg.hpp"
#include "stats/ptpe/placement_study.hpp"

using namespace stats;

namespace {

/// The pilot's 21 settings, or with a smaller step more of them up to a higher mean.
std::vector<PlacementSetting> settings(double step, double highest) {
  std::vector<PlacementSetting> out;
  for (double mu = 10; mu <= highest; mu += step)
    for (const double delta : {0.0, 5.0, 10.0, 15.0, 20.0})
      if (delta < mu) out.push_back({mu, delta});
  return out;
}

const std::vector<PlacementSetting> pilot = settings(10, 50), fine = settings(2.5, 70),
                                    wide = settings(2.5, 90);

}  // namespace

TEST(Placement, BracketsTheContourOfARaterWithoutNoise) {
  Placement placement(fine, placement_prior(fine), {.trials = 40, .between = 8});
  int smallest = 0, on = 0, between = 0, ends = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const int index = placement.next();
    const PlacementSetting& one = fine[static_cast<std::size_t>(index)];
    const double contour = 24 * std::exp(0.02 * one.delta);
    const bool inner = one.delta > 0 && one.delta < 20;
    EXPECT_EQ(inner, trial % 5 == 3) << trial;
    if (inner) {
      EXPECT_EQ(one.delta, 10) << trial;
    }
    between += inner;
    if (trial >= 15 && !inner) {
      const double distance = std::log(one.mu / contour) / std::log(1.42);
      EXPECT_NEAR(distance, std::round(distance), 0.45) << trial;
      EXPECT_LE(std::abs(std::round(distance)), 1) << trial;
      smallest += one.delta == 0;
      on += std::round(distance) == 0;
      ++ends;
    }
    placement.add(index, std::clamp(static_cast<int>(std::lround(4 + 0.14 * (one.mu - contour))), 1, 7));
  }
  EXPECT_EQ(between, 8);
  EXPECT_NEAR(smallest, 0.75 * ends, 1);
  EXPECT_NEAR(on, ends / 3.0, 2);
  EXPECT_NEAR(placement.a().mean, 24, 2.5);
  EXPECT_NEAR(placement.b().mean, 0.02, 0.005);
}

TEST(Placement, GoesTwoThirdsOfTheWayToTheContourOfThePeopleBefore) {
  Placement alone(fine, placement_prior(fine)), taught(fine, placement_prior(fine));
  const auto expected_score = [](const PlacementSetting& one) {
    const double contour = 18 * std::exp(0.01 * one.delta);
    return std::clamp(static_cast<int>(std::lround(4 + 0.14 * (one.mu - contour))), 1, 7);
  };
  for (int i = 0; i < static_cast<int>(fine.size()); ++i)
    taught.learn(i, expected_score(fine[static_cast<std::size_t>(i)]));
  EXPECT_NEAR(taught.a().mean, 18, 1);
  const double first = fine[static_cast<std::size_t>(taught.next())].mu / 1.42;
  EXPECT_NEAR(first, std::pow(18, 2.0 / 3) * std::pow(alone.a().mean, 1.0 / 3), 1.5);
}

TEST(Placement, TurnsOfDistancesBeginElsewhereForEachPerson) {
  Placement placement(fine, placement_prior(fine));
  std::set<double> means;
  for (int person = 0; person < 6; ++person) {
    placement.set_person(person);
    means.insert(fine[static_cast<std::size_t>(placement.next())].mu);
  }
  EXPECT_EQ(means.size(), 3u) << "above, on and below the contour";
  EXPECT_THROW(placement.set_person(-1), std::invalid_argument);
}

TEST(Placement, ShowsNoSettingTooOftenAndSaysWhenAllAreShown) {
  const std::vector<PlacementSetting> two{{10, 0}, {20, 0}};
  Placement placement(two, placement_prior(two), {.between = 0, .most_of_one = 2});
  for (int trial = 0; trial < 4; ++trial) placement.add(placement.next(), 4);
  EXPECT_THROW(placement.next(), std::logic_error);
}

TEST(Placement, RefusesWhatItCannotUse) {
  const std::vector<PlacementSetting> same{{10, 0}, {10, 5}}, one{{10, 0}};
  EXPECT_THROW(placement_prior(same), std::invalid_argument);
  EXPECT_THROW(placement_prior(one), std::invalid_argument);
  EXPECT_THROW(Placement(pilot, placement_prior(pilot), {.bracket = 1}), std::invalid_argument);
  EXPECT_THROW(Placement(pilot, placement_prior(pilot), {.trials = 2, .between = 3}), std::invalid_argument);
  Placement placement(pilot, placement_prior(pilot));
  EXPECT_THROW(placement.add(0, 8), std::invalid_argument);
}

TEST(Placement, AContourOfAnotherFormIsFoundAlsoWhereTheExponentialHasNoFit) {
  const PlacementStudy study{.truth = PlacementTruth::Hinge};
  const PlacementSummary placed = simulate_placement(study, pilot, wide, 16, 1);
  EXPECT_LT(placed.fitted, 15) << "each study has a fit, so that this test shows nothing";
  EXPECT_GE(placed.form_rejected, 0.5) << "found in .86 of 600 studies";
}

TEST(Placement, HalfOfTheTrialsGiveTheSameWidths) {
  PlacementStudy study;
  study.adaptive = false;
  const PlacementSummary all = simulate_placement(study, pilot, fine, 30, 1);
  study.adaptive = true;
  study.trials = 10;
  const PlacementSummary placed = simulate_placement(study, pilot, fine, 30, 1);
  EXPECT_EQ(placed.fitted, 30);
  EXPECT_LT(placed.b_width, 1.1 * all.b_width);
  EXPECT_LT(placed.a_width, 1.1 * all.a_width);
  EXPECT_GE(placed.a_covered, 0.8);
}

namespace {

/// Widths of the intervals of a placed study as shares of those of the fixed settings.
struct Widths {
  double a_truth = 0, b_truth = 0;
  int trials = 0;
  double a = 0, b = 0;
};

/// The figure of docs/statistics.md: one panel for a and one for b, with a line for each truth.
std::string figure_of(const std::vector<Widths>& all) {
  const std::vector<const char*> colours{svg::colour::blue, svg::colour::vermilion, svg::colour::green};
  const std::vector<const char*> dashes{"none", "6 3", "2 3"};
  constexpr double left = 60, bottom = 270, panel = 300, height = 230, least = 0.5, most = 2.2;
  svg::Picture picture{720, 345, "placement", "Widths of intervals by the number of placed trials"};
  picture.description = "Widths of the intervals of a and of b as shares of those of 21 fixed settings";
  std::string& body = picture.body;
  for (const int part : {0, 1}) {
    const double from = left + part * (panel + 50);
    const auto x = [&](double trials) { return from + (trials - 6) / 9 * panel; };
    const auto y = [&](double width) { return bottom - (width - least) / (most - least) * height; };
    for (const double width : {0.5, 1.0, 1.5, 2.0}) {
      body += svg::line({from, y(width)}, {from + panel, y(width)},
                        svg::attribute("stroke", width == 1 ? "#000000" : "#cccccc"));
      body +=
          svg::text({from - 8, y(width) + 4}, svg::number(width, 1), svg::attribute("text-anchor", "end"));
    }
    for (const int trials : {7, 10, 14})
      body += svg::text({x(trials), bottom + 18}, std::to_string(trials),
                        svg::attribute("text-anchor", "middle"));
    body += svg::text({from, 24}, part == 0 ? "width of the interval of ln a" : "width of the interval of b");
    body += svg::text({from + panel, bottom + 40}, "trials of each person; 1: as 21 fixed settings",
                      svg::attribute("text-anchor", "end"));
    for (std::size_t truth = 0; truth < 9; ++truth) {
      std::string moves;
      for (std::size_t i = 0; i < 3; ++i) {
        const Widths& one = all[3 * truth + i];
        moves += svg::move(i == 0 ? 'M' : 'L', {x(one.trials), y(part == 0 ? one.a : one.b)});
      }
      body += svg::path(moves, svg::attribute("fill", "none") + svg::attribute("stroke-width", "2") +
                                   svg::attribute("stroke", colours[truth / 3]) +
                                   svg::attribute("stroke-dasharray", dashes[truth % 3]));
    }
  }
  const std::vector<const char*> values{"a = 18", "a = 24", "a = 31"},
      slopes{"b = .01", "b = .02", "b = .03"};
  for (std::size_t i = 0; i < 3; ++i) {
    const double at = 70 + 110 * static_cast<double>(i);
    body += svg::line({at, 322}, {at + 24, 322},
                      svg::attribute("stroke", colours[i]) + svg::attribute("stroke-width", "2"));
    body += svg::text({at + 30, 326}, values[i]);
    body += svg::line({at + 340, 322}, {at + 364, 322},
                      svg::attribute("stroke", "#000000") + svg::attribute("stroke-width", "2") +
                          svg::attribute("stroke-dasharray", dashes[i]));
    body += svg::text({at + 370, 326}, slopes[i]);
  }
  return svg::document(picture);
}

}  // namespace

/// Prints the widths of docs/statistics.md, "Adaptive placement". VIP_FIGURE names a file for its figure.
TEST(PlacementSlow, WidthsBesideFixedSettings) {
  int same_width = 0, truths = 0;
  std::vector<Widths> widths;
  for (const PlacementTruth truth : {PlacementTruth::Model, PlacementTruth::Lapses, PlacementTruth::Drift}) {
    for (const double a : {18.0, 24.0, 31.0}) {
      for (const double b : {0.01, 0.02, 0.03}) {
        PlacementStudy study{.a = a, .b = b, .truth = truth, .adaptive = false};
        const PlacementSummary all = simulate_placement(study, pilot, wide, 600, 1);
        study.adaptive = true;
        for (const int trials : {7, 10, 14}) {
          study.trials = trials;
          const PlacementSummary placed = simulate_placement(study, pilot, wide, 600, 1);
          const double wider_a = placed.a_width / all.a_width, wider_b = placed.b_width / all.b_width;
          std::printf(
              "%s a %g b %g trials %d: fitted %.3f, width a %.2f b %.2f, covered %.3f %.3f (fixed %.3f "
              "%.3f)\n",
              placement_truth_word(truth), a, b, trials, placed.fitted / 600.0, wider_a, wider_b,
              placed.a_covered, placed.b_covered, all.a_covered, all.b_covered);
          if (truth == PlacementTruth::Model) widths.push_back({a, b, trials, wider_a, wider_b});
          if (truth != PlacementTruth::Model || trials != 10) continue;
          ++truths;
          same_width += wider_a <= 1.05 && wider_b <= 1.05;
          EXPECT_GT(placed.b_covered, 0.91);
          EXPECT_GT(placed.a_covered, 0.91);
        }
      }
    }
  }
  EXPECT_GE(same_width, 6) << "of " << truths;
  if (const char* file = std::getenv("VIP_FIGURE")) base::write_file_atomically(file, figure_of(widths));
}

/// Prints the checks of docs/statistics.md, "Adaptive placement": shares of studies in which the form test,
/// the drift test and the test for lapses find something.
TEST(PlacementSlow, ChecksOfTheModelFindWhatIsWrong) {
  for (const PlacementTruth truth :
       {PlacementTruth::Model, PlacementTruth::Linear, PlacementTruth::Hinge, PlacementTruth::Drift,
        PlacementTruth::Lapses, PlacementTruth::LowestLapses}) {
    for (const double a : {18.0, 24.0, 31.0}) {
      for (const double b : {0.01, 0.02, 0.03}) {
        PlacementStudy study{.a = a, .b = b, .truth = truth, .adaptive = false};
        const PlacementSummary all = simulate_placement(study, pilot, wide, 600, 1);
        study.adaptive = true;
        const PlacementSummary placed = simulate_placement(study, pilot, wide, 600, 1);
        std::printf(
            "%s a %g b %g: form %.3f (fixed %.3f), drift %.3f (%.3f), lapses %.3f (%.3f), far answers %.3f "
            "(%.3f), fitted "
            "%.3f (%.3f)\n",
            placement_truth_word(truth), a, b, placed.form_rejected, all.form_rejected, placed.drift_found,
            all.drift_found, placed.lapses_found, all.lapses_found, placed.far_found, all.far_found,
            placed.fitted / 600.0, all.fitted / 600.0);
        if (truth == PlacementTruth::Hinge) {
          EXPECT_GE(placed.form_rejected, all.form_rejected - 0.15);
        }
        if (truth == PlacementTruth::Drift) {
          EXPECT_GE(placed.drift_found, 0.7);
        }
        if (truth == PlacementTruth::LowestLapses) {
          EXPECT_GE(placed.lapses_found, 0.85);
        }
        if (truth == PlacementTruth::Lapses) {
          EXPECT_GE(placed.far_found, 0.4);
        }
        if (truth != PlacementTruth::Model) continue;
        EXPECT_LE(placed.far_found, 0.06);
        EXPECT_LE(placed.form_rejected, 0.09);
        EXPECT_LE(placed.drift_found, 0.09);
        EXPECT_LE(placed.lapses_found, 0.02);
      }
    }
  }
}
