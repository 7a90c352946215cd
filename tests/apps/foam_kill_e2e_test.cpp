/// A session of live fluid with foam as a factor is killed in the middle of a showing and resumed: nothing is
/// lost, and the later showings equal those of an undisturbed session.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "libstudy/runner/cell_stimuli.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/common/needs_effects.hpp"

namespace apps::test {
namespace {

using ::testing::HasSubstr;

/// protocols/foam.toml, coarse and short. Foam alone does not change the water, so one level adds drag: then
/// the records of frames differ between the levels.
std::string short_foam() {
  return replaced(with_keys(coarse(shipped_text("foam")), {{"effects", "[\"none\", \"foam\", \"scene\"]"}}),
                  "keep = [\"foam\"]",
                  "effect = [{kind = \"foam\", emission_per_s = 3}, {kind = \"air_drag\", rate_per_s = 9}]");
}

using Rows = std::vector<std::string>;

Rows rows_of(const std::string& database, const std::string& sql) {
  study::sqlite::Connection file(database, study::sqlite::Open::Read);
  study::sqlite::Statement row(file, sql);
  Rows out;
  while (row.step()) out.push_back(row.text(0));
  return out;
}

const char* const plan =
    "SELECT u.position || ' ' || u.kind || ' ' || coalesce(t.first_cell || ' ' || t.second_cell || ' ' || "
    "t.schedule_seed, '') FROM unit u LEFT JOIN trial t USING (trial_id) ORDER BY u.position";

/// The last showing of each trial, frame by frame, with the number of particles projected at walls.
const char* const shown =
    "SELECT t.position || ' ' || p.interval || ' ' || c.effects || ' ' || f.frame_index || ' ' || "
    "f.content_step || ' ' || f.simulation_time_s || ' ' || f.particles || ' ' || "
    "coalesce(f.wall_projected, '') FROM frame f JOIN presentation p USING (presentation_id) JOIN trial t "
    "USING (trial_id) JOIN session s USING (session_id) JOIN cell c ON c.protocol_id = s.protocol_id AND "
    "c.cell = p.cell WHERE p.state = 'played' AND p.attempt = (SELECT max(attempt) FROM presentation q WHERE "
    "q.trial_id = p.trial_id) ORDER BY t.position, p.interval, f.frame_index";

class FoamKillE2e : public ::testing::Test {
 protected:
  FoamKillE2e() { base::write_file_atomically(protocol_, short_foam()); }
  std::vector<std::string> arguments(const std::string& database) const {
    return {vip_study, "run",       protocol_,    "--db",          database, "--size",  "64x36",
            "--clock", "virtual",   "--observer", "random",        "--seed", "5",       "--backend",
            "cpu",     "--display", "headless",   "--participant", "P01",    "--events"};
  }
  /// Kills the run while the second stimulus of the trial at position `trial` is shown.
  std::string run_and_kill(const std::string& database, int trial) const {
    Process program(arguments(database));
    program.read_line();  // the plan is written
    const std::string on =
        "SELECT count(*) FROM presentation p JOIN trial t USING (trial_id) WHERE p.state "
        "= 'running' AND p.interval = 1 AND t.position = " +
        std::to_string(trial);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (count_in(database, on) == 0 && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    program.send(SIGKILL);
    return program.wait().out;
  }

  TemporaryFolder folder_;
  const std::string protocol_ = folder_ / "foam.toml", whole_ = folder_ / "whole.db",
                    killed_ = folder_ / "killed.db";
};

TEST_F(FoamKillE2e, LiveWaterAndItsPlanGoOnAsIfNothingHadBeen) {
  NEEDS_EFFECTS;
  const Ended whole = run_program(arguments(whole_));
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const std::string told = run_and_kill(killed_, 2);
  const Rows planned = rows_of(killed_, plan);
  const Answers before = answers_in(killed_);
  const Units done = done_in(killed_);
  const std::string stimulus = rows_of(killed_, "SELECT stimulus FROM session").at(0);
  ASSERT_EQ(count_in(killed_, "SELECT count(*) FROM presentation WHERE state = 'running'"), 1);
  for (const auto& key : acknowledged(told)) EXPECT_TRUE(done.contains(key)) << key.second;
  ASSERT_LT(done.size(), done_in(whole_).size());

  const Ended resumed = run_program({vip_study, "resume", "--db", killed_, "--events"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(rows_of(killed_, plan), planned);
  EXPECT_EQ(planned, rows_of(whole_, plan));
  for (const auto& [key, answer] : before) EXPECT_EQ(answers_in(killed_).at(key), answer);
  for (const auto& key : acknowledged(resumed.out)) EXPECT_FALSE(done.contains(key)) << "asked twice";
  EXPECT_EQ(done_in(killed_), done_in(whole_));
  EXPECT_EQ(answers_in(killed_).size(), answers_in(whole_).size());

  // Every frame shows water with the effects of its level, beginning at the protocol's start step.
  const Rows frames = rows_of(whole_, shown);
  EXPECT_EQ(frames.size(), 8u * 15);
  EXPECT_EQ(rows_of(killed_, shown), frames);
  const auto walls = [&](const std::string& level) {
    return rows_of(whole_,
                   "SELECT DISTINCT sum(f.wall_projected) FROM frame f JOIN presentation p USING "
                   "(presentation_id) JOIN cell c USING (cell) WHERE c.effects = '" +
                       level + "' GROUP BY presentation_id");
  };
  EXPECT_EQ(walls("none").size(), 1u) << "each showing of a level is the same water";
  EXPECT_EQ(walls("scene"), walls("none")) << "foam rides one way";
  EXPECT_NE(walls("foam"), walls("none")) << "and drag does not";
  EXPECT_EQ(rows_of(killed_, "SELECT stimulus FROM session"), Rows{stimulus});
  EXPECT_THAT(stimulus, HasSubstr("; foam emission_per_s = 3 "));

  // The interrupted showing is recorded, and its whole trial was shown again.
  EXPECT_THAT(rows_of(killed_,
                      "SELECT t.position || ' ' || p.attempt || ' ' || p.interval || ' ' || p.state "
                      "FROM presentation p JOIN trial t USING (trial_id) WHERE t.position = 2 ORDER "
                      "BY presentation_id"),
              ::testing::ElementsAre("2 1 0 played", "2 1 1 interrupted", "2 2 0 played", "2 2 1 played"));
  EXPECT_EQ(count_in(killed_, "SELECT count(*) FROM event WHERE kind = 'resumed'"), 1);
  EXPECT_EQ(count_in(killed_, "SELECT count(*) FROM presentation WHERE state = 'interrupted'"), 1);
  // The report counts each pair of levels once.
  const std::string results = folder_ / "results.json", vip_stats = VIP_BIN_DIR "/vip-stats";
  const Ended reported = run_program({vip_stats, "report", killed_, "--json", results});
  ASSERT_EQ(reported.exit_code, 0) << reported.err;
  const auto pairs = base::Json::parse(base::read_file(results, 1 << 24)).at("task2").at("pairs");
  ASSERT_EQ(pairs.size(), 3u);
  for (const auto& pair : pairs) EXPECT_EQ(pair.at("n"), 1) << pair;
}

std::vector<float> foam_at(study::CellStimuli& stimuli, const study::Protocol& protocol, std::size_t cell,
                           std::int64_t first, std::int64_t last) {
  auto& fluid = dynamic_cast<study::LiveFluid&>(stimuli.stimulus(protocol.design.cells[cell]));
  fluid.start(first);
  for (std::int64_t step = first; step <= last; ++step) fluid.prepare(step);
  std::vector<sim::RenderParticle> foam;
  fluid.simulation().read_foam(foam);
  std::vector<float> out;
  for (const auto& p : foam) out.insert(out.end(), {p.x_m, p.y_m, p.z_m, p.radius_m});
  return out;
}

TEST(FoamKill, FoamOfACutShowingIsNotThereWhenItIsShownAgain) {
  NEEDS_EFFECTS;
  const auto protocol = study::parse_protocol(short_foam(), "p.toml");
  study::RunOptions options;
  options.display = "headless";
  options.backend = "cpu";
  study::CellStimuli fresh(options, protocol, {}, {});
  const auto wanted = foam_at(fresh, protocol, 1, 30, 60);
  ASSERT_GT(wanted.size(), 4u * 20);

  study::CellStimuli stimuli(options, protocol, {}, {});
  EXPECT_TRUE(foam_at(stimuli, protocol, 0, 30, 40).empty()) << "level none";
  const auto cut = foam_at(stimuli, protocol, 1, 30, 75);
  EXPECT_NE(cut, wanted);
  EXPECT_EQ(foam_at(stimuli, protocol, 1, 30, 60), wanted) << "the same stimulus, rewound";
  EXPECT_TRUE(foam_at(stimuli, protocol, 0, 30, 40).empty());
  EXPECT_EQ(foam_at(stimuli, protocol, 1, 30, 60), wanted) << "made anew";
}

}  // namespace
}  // namespace apps::test
