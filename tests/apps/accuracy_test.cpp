/// vip-bench accuracy: its file, and its results from the cells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "libstudy/sweep/run/accuracy_page.hpp"
#include "libstudy/sweep/run/run_cell.hpp"
#include "libstudy/sweep/run/work_precision.hpp"
#include "stats/base/error.hpp"
#include "stats/figures/log_chart.hpp"
#include "tests/apps/small_sweep.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps {
namespace {

using study::sqlite::Open;
using test::run_with;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(AccuracySample, MassesWeigh) {
  // A particle of level 1 has twice the mass of one of level 0.
  const auto sample =
      study::sample_of(0.5, {{.id = 0, .level = 1, .x_m = 0, .y_m = 3, .z_m = 1, .vx_m_s = 2},
                             {.id = 1, .level = 0, .x_m = 3, .y_m = 0, .z_m = 1, .vy_m_s = 4}});
  EXPECT_DOUBLE_EQ(sample.time_s, 0.5);
  EXPECT_DOUBLE_EQ(sample.centre_m[0], 1);
  EXPECT_DOUBLE_EQ(sample.centre_m[1], 2);
  EXPECT_DOUBLE_EQ(sample.centre_m[2], 1);
  EXPECT_DOUBLE_EQ(sample.kinetic_j_kg, (2 * 2 + 8) / 3.0);
  EXPECT_DOUBLE_EQ(sample.front_m, 3);
}

TEST(AccuracySample, TheFrontLeavesOnePerCentOfTheMassBefore) {
  std::vector<sim::ParticleState> water;
  for (int i = 0; i < 1000; ++i) water.push_back({.id = i, .x_m = static_cast<float>(i)});
  EXPECT_DOUBLE_EQ(study::sample_of(0, water).front_m, 989);
}

TEST(AccuracyErrors, AreRootMeanSquaresInPerCent) {
  const auto errors = study::water_errors(run_with(3, 11, 1), run_with(1, 10, 1), 20);
  EXPECT_DOUBLE_EQ(errors[0], 10);
  EXPECT_DOUBLE_EQ(errors[1], 5);
  EXPECT_DOUBLE_EQ(errors[2], 10);
  EXPECT_DOUBLE_EQ(errors[3], 0.1);
  auto uneven = run_with(1, 10, 1);
  uneven.samples[1].front_m = 4;
  EXPECT_DOUBLE_EQ(study::water_errors(uneven, run_with(1, 10, 1), 100)[0], 3 / std::sqrt(2.0));
  auto shorter = uneven;
  shorter.samples.pop_back();
  EXPECT_THROW(study::water_errors(shorter, uneven, 1), base::Error);
  shorter = uneven;
  shorter.samples[0].time_s = 0.15;
  EXPECT_THROW(study::water_errors(shorter, uneven, 1), base::Error);
}

const study::SweepPlan small_plan{.n_star = 512};
const study::SweepOrigin origin{"a machine", "0.1.0 abc", "feed"};

study::StoredCell stored(const sim::SolverSetting& setting, int seed, const study::CellRun& run) {
  const study::SweepCell cell{setting, seed, small_plan.seconds, small_plan.size};
  return {cell, origin, run};
}

/// A made-up sweep: a reference, HiRes with usual settings, and HiRes with two other numbers of projections.
/// The fronts of the two runs of the reference differ by 0.01 m, 0.1 % of a tank of 10 m. No smaller error
/// can be measured.
std::vector<study::StoredCell> small_sweep() {
  const auto reference = study::reference_setting("SingleDam", 512);
  const auto usual = sim::usual_setting("SingleDam", sim::MethodKind::HiRes, 512);
  auto eight = usual, three = usual;
  eight[sim::SolverKnob::Iterations] = 8;
  three[sim::SolverKnob::Iterations] = 3;
  auto as_quick = run_with(1.3, 10, 10);
  for (std::size_t i = 0; i < as_quick.frames.size(); ++i) as_quick.frames[i].solve_ms += i % 2 ? 0.5 : -0.5;
  return {stored(reference, 1, run_with(1, 10, 100)),
          stored(reference, 2, run_with(1.01, 10, 100)),
          stored(three, 1, as_quick),
          stored(usual, 1, run_with(1.2, 10, 10)),
          stored(usual, 2, run_with(1.3, 10, 10)),
          stored(eight, 1, run_with(1.1, 10, 14)),
          stored(eight, 2, run_with(1.12, 10, 14, 0.002))};
}

TEST(AccuracyPrices, ArePairsOfMillisecondsAndErrors) {
  const auto list = study::price_list(small_sweep(), small_plan, origin, 10);
  EXPECT_NEAR(list.floor[0], 0.1, 1e-9);
  ASSERT_EQ(list.settings.size(), 3u);
  ASSERT_EQ(list.prices.size(), 2u);
  const study::Price& three = list.prices[0];
  EXPECT_TRUE(three.free()) << "its frames are faster and slower by turns";
  const study::Price& eight = list.prices[1];
  EXPECT_EQ(eight.knob, sim::SolverKnob::Iterations);
  EXPECT_DOUBLE_EQ(eight.from, 4);
  EXPECT_DOUBLE_EQ(eight.to, 8);
  EXPECT_DOUBLE_EQ(eight.ms, 4);
  EXPECT_FALSE(eight.free());
  EXPECT_NEAR(eight.errors[0].mean, (1 + 1.2) / 2 - (2 + 3) / 2.0, 1e-9);
  EXPECT_NEAR(eight.errors[0].low, 1 - 3, 1e-9);
  EXPECT_NEAR(eight.errors[0].high, 1.2 - 2, 1e-9);
  EXPECT_NEAR(eight.errors[3].high, 0.1, 1e-9);
  const std::string text = study::to_markdown(list);
  EXPECT_THAT(text, HasSubstr("| HiRes | projections | 4 to 8 | +4.00 [+4.00, +4.00] | -1.4 [-2, -0.8] |"));
  EXPECT_THAT(text, HasSubstr("| HiRes | projections | 4 to 3 | free |"));
  EXPECT_THAT(text, HasSubstr("was not compared with finer ones"));
  EXPECT_THAT(figures::to_csv(study::price_table(list)),
              HasSubstr("iterations,4,8,4.000,4.000,4.000,no,-1.4000"));
}

TEST(AccuracyPrices, AReferenceCountsAsConvergedByAThirdOfTheSmallestError) {
  for (const double moved : {0.03, 0.05}) {  // of 10 m: 0.3 and 0.5 %; the smallest error is 1.1 %
    auto cells = small_sweep();
    for (const auto& finer : study::finer_references(study::reference_setting("SingleDam", 512)))
      cells.push_back(stored(finer, 1, run_with(1 + moved, 10, 200)));
    const auto list = study::price_list(cells, small_plan, origin, 10);
    EXPECT_EQ(list.finer.size(), 3u);
    EXPECT_EQ(list.settings.size(), 3u) << "what judges the reference is no choice";
    EXPECT_EQ(list.converged[0], moved < 0.04);
    EXPECT_THAT(study::to_markdown(list), HasSubstr(moved < 0.04 ? "0.1 %; the reference counts as converged"
                                                                 : "0.1 %; the reference does not count"));
  }
}

TEST(AccuracyPrices, NeverMixMachinesProgramsOrScenes) {
  auto cells = small_sweep();
  const auto alone = study::to_markdown(study::price_list(cells, small_plan, origin, 10));
  for (const int what : {0, 1, 2}) {
    auto other = stored(sim::usual_setting("SingleDam", sim::MethodKind::LoRes, 512), 1, run_with(5, 5, 5));
    if (what == 0) other.origin.machine = "another";
    if (what == 1) other.origin.program = "0.2.0 def";
    if (what == 2) other.origin.scene_sha256 = "beef";
    cells.push_back(other);
  }
  EXPECT_EQ(study::to_markdown(study::price_list(cells, small_plan, origin, 10)), alone);
  cells.erase(cells.begin());
  EXPECT_THAT([&] { study::price_list(cells, small_plan, origin, 10); },
              ThrowsMessage<base::Error>(HasSubstr("no finished reference")));
}

TEST(AccuracyFront, HoldsWhatNoneBeats) {
  const auto setting = [](double ms, double error) {
    study::SettingResult out;
    out.ms_mean = ms;
    out.errors[2].mean = error;
    return out;
  };
  const std::vector<study::SettingResult> settings{setting(9, 1), setting(4, 3),  setting(5, 3),
                                                   setting(4, 4), setting(12, 1), setting(2, 8),
                                                   setting(6, 2)};
  EXPECT_EQ(study::pareto_front(settings, study::SweepError::Kinetic),
            (std::vector<std::size_t>{5, 1, 6, 0}));
  EXPECT_TRUE(study::pareto_front({}, study::SweepError::Kinetic).empty());
}

TEST(AccuracyFront, MoreSeedsAreOfItsSettingsOnly) {
  auto sweep = small_sweep();
  auto worse = sim::usual_setting("SingleDam", sim::MethodKind::HiRes, 512);
  worse[sim::SolverKnob::Substeps] = 4;
  sweep.push_back(stored(worse, 1, run_with(2, 20, 50, 0.01)));
  const auto list = study::price_list(sweep, small_plan, origin, 10);
  std::set<std::string> on_front, asked;
  for (std::size_t e = 0; e < study::sweep_error_count; ++e)
    for (const auto i : study::pareto_front(list.settings, static_cast<study::SweepError>(e)))
      on_front.insert(sim::to_text(list.settings[i].setting));
  EXPECT_FALSE(on_front.contains(sim::to_text(worse)));
  const auto cells = study::more_seeds_of_fronts(list, small_plan, 5);
  EXPECT_EQ(cells.size(), 5 * on_front.size());
  for (const auto& cell : cells) asked.insert(sim::to_text(cell.setting));
  EXPECT_EQ(asked, on_front);
  EXPECT_EQ(cells[4].seed, 5);
  EXPECT_EQ(cells[4].seconds, small_plan.seconds);
}

TEST(LogAxis, EndsOutsideTheValues) {
  EXPECT_EQ(figures::log_ticks(3, 40), (std::vector<double>{2, 5, 10, 20, 50}));
  EXPECT_EQ(figures::log_ticks(10, 10), (std::vector<double>{10, 20}));
  EXPECT_EQ(figures::log_ticks(2, 9000), (std::vector<double>{1, 10, 100, 1000, 10000})) << "powers alone";
  const figures::LogScale scale{1, 100};
  EXPECT_DOUBLE_EQ(scale.share(10), 0.5);
}

TEST(AccuracyPage, ShowsEachErrorTheFrontsAndThePrices) {
  const auto list = study::price_list(small_sweep(), small_plan, origin, 10);
  const auto page = study::accuracy_page(list, small_plan);
  for (const char* words :
       {"<h1>What accuracy costs in time: SingleDam</h1>", "Error of front", "Error of centre of mass",
        "Error of kinetic energy", "Error of density", "a machine", "0.1.0 abc", "The floor is 0.1 %",
        "was not compared with finer ones", "<td>+4.00 [+4.00, +4.00]</td>", "<td>free</td>",
        "n_* = 512, 2 s of content; seeds a setting: 1 to 2", "the solver alone; nothing was drawn"}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
  EXPECT_THAT(page, ::testing::Not(HasSubstr("http"))) << "needs nothing from elsewhere";
  const auto picture = study::work_precision(list, study::SweepError::Front);
  ASSERT_TRUE(picture);
  EXPECT_THAT(picture->body, HasSubstr(">60 Hz<"));
  EXPECT_THAT(picture->body, HasSubstr(">floor<"));
}

TEST(AccuracyPage, SaysWhereThereIsNothingToDraw) {
  auto list = study::price_list(small_sweep(), small_plan, origin, 10);
  for (auto& one : list.settings) one.errors[1] = {};
  EXPECT_FALSE(study::work_precision(list, study::SweepError::Centre));
  EXPECT_THAT(study::accuracy_page(list, small_plan), HasSubstr("No setting has an error above 0."));
}

std::string bytes_of(const std::filesystem::path& path) { return base::read_file(path, 1 << 24); }

TEST(SweepFile, GivesBackWhatItWasGiven) {
  const ::test::TemporaryFolder folder;
  auto cell = stored(sim::usual_setting("SingleDam", sim::MethodKind::OursTsp, 512), 2, run_with(1.25, 7, 3));
  cell.cell.size = "640x360";
  cell.run.frames[3].draw_ms = 1.5;
  cell.run.particles_mean = 123.5;
  cell.run.substeps_mean = 2.25;
  cell.run.braked = 4;
  {
    study::SweepFile file(folder / "a.db", Open::Create);
    file.add(cell);
    file.add(cell);
  }
  study::SweepFile file(folder / "a.db", Open::Read);
  const auto cells = file.cells();
  ASSERT_EQ(cells.size(), 1u);
  const auto& found = cells[0];
  EXPECT_EQ(found.key(), cell.key());
  EXPECT_EQ(found.cell, cell.cell);
  EXPECT_EQ(found.origin, cell.origin);
  EXPECT_EQ(found.run.particles_mean, 123.5);
  EXPECT_EQ(found.run.substeps_mean, 2.25);
  EXPECT_EQ(found.run.braked, 4);
  ASSERT_EQ(found.run.samples.size(), 2u);
  EXPECT_EQ(found.run.samples[1].time_s, 0.2);
  EXPECT_EQ(found.run.samples[1].centre_m[1], 0.625);
  EXPECT_EQ(study::water_errors(found.run, cell.run, 1)[2], 0);
  ASSERT_EQ(found.run.frames.size(), 8u);
  EXPECT_FALSE(found.run.frames[2].draw_ms);
  EXPECT_EQ(found.run.frames[3].all_ms(), cell.run.frames[3].all_ms());
  EXPECT_EQ(file.keys("a machine"), std::set<std::string>{cell.key()});
  EXPECT_TRUE(file.keys("another").empty());
}

TEST(SweepFile, ShardsInAnyOrderGiveTheSameCells) {
  const ::test::TemporaryFolder folder;
  const auto cells = small_sweep();
  const auto in_order = [](study::SweepFile&& file) {
    std::vector<std::string> keys;
    for (const auto& cell : file.cells()) keys.push_back(cell.key());
    return keys;
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    study::SweepFile(folder / (std::to_string(i) + ".db"), Open::Create).add(cells[i]);
    study::SweepFile(folder / "serial.db", Open::Create).add(cells[i]);
  }
  {
    study::SweepFile merged(folder / "merged.db", Open::Create);
    for (std::size_t i = cells.size(); i-- > 0;)
      EXPECT_EQ(merged.merge(folder / (std::to_string(i) + ".db")), 1);
    EXPECT_EQ(merged.merge(folder / "serial.db"), 0);
  }
  EXPECT_EQ(in_order(study::SweepFile(folder / "merged.db", Open::Read)),
            in_order(study::SweepFile(folder / "serial.db", Open::Read)));
}

TEST(SweepFile, WhatIsNoneIsRefusedAndLeftAsItIs) {
  const ::test::TemporaryFolder folder;
  const auto path = folder / "a.db";
  study::SweepFile(path, Open::Create).add(small_sweep()[0]);
  const std::string sound = bytes_of(path);
  const auto refused = [&](const std::string& bytes, const char* why) {
    base::write_file_atomically(folder / "b.db", bytes);
    for (const auto how : {Open::Read, Open::Create}) {
      EXPECT_THAT([&] { study::SweepFile(folder / "b.db", how); },
                  ThrowsMessage<base::Error>(HasSubstr(why)));
      EXPECT_EQ(bytes_of(folder / "b.db"), bytes) << why;
    }
  };
  refused("time,ms\n" + std::string(200, '1'), "not a sweep file");
  refused(sound.substr(0, 50), "not a sweep file");
  auto foreign = sound, newer = sound;
  foreign[68] = 'X';  // a byte of application_id
  newer[63] = 9;      // the last byte of user_version
  auto older = sound;
  older[63] = 1;
  refused(older, "older program (schema 1");
  refused(foreign, "not a sweep file");
  refused(newer, "newer program (schema 9");
  refused(sound.substr(0, sound.size() / 2), "is damaged or cut short\n  mend: name another file");
  EXPECT_THROW(study::SweepFile(folder / "none.db", Open::Read), base::Error);
  base::write_file_atomically(folder / "empty.db", "");
  EXPECT_THROW(study::SweepFile(folder / "empty.db", Open::Read), base::Error);
  EXPECT_TRUE(study::SweepFile(folder / "empty.db", Open::Create).cells().empty());
}

class AccuracyE2e : public test::TableTest {
 protected:
  const std::string sweep = "accuracy --quick --n-star 64 --seconds 0.1 --seeds 1";
  /// Times of each cell of a sweep file, by key; empty while another program writes to the file.
  std::map<std::string, std::vector<double>> times_of(const std::string& name) const {
    std::map<std::string, std::vector<double>> out;
    try {
      for (const auto& cell : study::SweepFile(path(name), Open::Read).cells())
        for (const auto& frame : cell.run.frames) out[cell.key()].push_back(frame.solve_ms);
    } catch (const base::Error&) {
      return {};
    }
    return out;
  }
};

TEST_F(AccuracyE2e, AKilledSweepGoesOnAndKeepsItsCells) {
  const std::string command = sweep + " --db " + path("killed.db");
  std::map<std::string, std::vector<double>> kept;
  {
    test::Process killed({"/bin/sh", "-c", line_of("vip-bench " + command + " --backend cpu")});
    while ((kept = times_of("killed.db")).size() < 3 && ::kill(killed.pid(), 0) == 0) ::usleep(10'000);
    killed.send(SIGKILL);
    ASSERT_EQ(killed.wait().signal, SIGKILL);
  }
  kept = times_of("killed.db");
  ASSERT_GE(kept.size(), 3u);
  ASSERT_LT(kept.size(), 13u);
  const auto again = table(command);
  ASSERT_EQ(again.exit_code, 0) << again.out;
  const auto all = times_of("killed.db");
  EXPECT_EQ(all.size(), 13u);
  for (const auto& [key, times] : kept) EXPECT_EQ(all.at(key), times) << key << " was run again";
}

TEST_F(AccuracyE2e, CellsRunApartAndMergedGiveTheSerialRunsTable) {
  const auto serial = table(sweep + " --db " + path("serial.db") + " --csv " + path("serial.csv") +
                            " --html " + path("serial.html"));
  ASSERT_EQ(serial.exit_code, 0) << serial.out;
  EXPECT_THAT(serial.out, HasSubstr("| Ours-TSp |"));
  EXPECT_THAT(bytes_of(path("serial.html")), HasSubstr("</html>"));
  const auto listed = table(sweep + " --list");
  std::istringstream lines(listed.out);
  std::string shards;
  int number = 0;
  for (std::string key, rest; lines >> key && std::getline(lines, rest);) {
    const std::string shard = path("shard" + std::to_string(number++) + ".db");
    const auto ended = table(sweep + " --cell " + key + " --out " + shard);
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
    shards = " " + shard + shards;
  }
  EXPECT_EQ(number, 13);
  const auto merged =
      test::run_shell(VIP_BIN_DIR "/vip-bench accuracy merge --db " + path("merged.db") + shards);
  ASSERT_EQ(merged.exit_code, 0) << merged.out;
  EXPECT_THAT(merged.out, HasSubstr("13 cells added from 13 files"));
  const auto again = table(sweep + " --table --db " + path("merged.db") + " --csv " + path("merged.csv"));
  ASSERT_EQ(again.exit_code, 0) << again.out;
  const auto rows = timeless("serial.csv");
  EXPECT_EQ(rows.size(), 11u);
  EXPECT_EQ(timeless("merged.csv"), rows);
}

TEST_F(AccuracyE2e, WrongWordsAreNamedWithTheirMend) {
  for (const auto& [words, place] : std::vector<std::pair<std::string, std::string>>{
           {"accuracy", "--db: is missing"},
           {"accuracy --scene all --db " + path("a.db"), "--scene all"},
           {"accuracy --scene Pond --db " + path("a.db"), "--scene Pond"},
           {"accuracy --n-star 128 --db " + path("a.db"), "--n-star 128"},
           {"accuracy --cell 0123 --out " + path("a.db"), "--cell 0123"},
           {"accuracy --table --db " + path("a.db"), "a.db"}}) {
    const auto ended = table(words);
    EXPECT_EQ(ended.exit_code, 1) << words << ended.out;
    EXPECT_THAT(ended.out, HasSubstr(place)) << words;
    EXPECT_FALSE(std::filesystem::exists(path("a.db"))) << words;
  }
  const auto merged = test::run_shell(VIP_BIN_DIR "/vip-bench accuracy merge --db " + path("a.db") +
                                      " " VIP_TEST_DIR "/README.md");
  EXPECT_EQ(merged.exit_code, 1);
  EXPECT_THAT(merged.out, HasSubstr("README.md: is not a sweep file"));
  EXPECT_FALSE(std::filesystem::exists(path("a.db")));
}

}  // namespace
}  // namespace apps
