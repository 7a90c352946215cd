#include "libsim/measure/peers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string head =
    "program,solver,particles,dt_s,iterations,backend,threads,ms_a_step,density_error_percent,source\n";

class Peers : public ::testing::Test {
 protected:
  std::vector<measure::PeerRow> read(const std::string& text) {
    base::write_file_atomically(file, text);
    return measure::read_peers(file);
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const base::Error& error) {
      return error.what();
    }
    return "";
  }

  ::test::TemporaryFolder folder;
  const std::string file = folder / "peers.csv";
};

measure::OurRow ours_on(const std::string& machine) {
  return measure::our_row({{"particles", 32768},
                           {"backend", "cpu"},
                           {"threads", 2},
                           {"solve_ms_mean", 20.5},
                           {"solve_ms_p95", 25.25},
                           {"density_error_mean", 0.00125},
                           {"neighbours_mean", 31.5},
                           {"substeps_mean", 1.25}},
                          0.005, 4, machine);
}

TEST_F(Peers, KeepsWhatIsKnownAndWhatIsNot) {
  const auto rows =
      read(head + "A,PBF,32768,0.005,4,cpu,2,73,0.61,somewhere\nB,DFSPH,8,0.01,,cpu,,58,,there\n");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].program, "A");
  EXPECT_EQ(rows[0].particles, 32768);
  EXPECT_EQ(rows[0].dt_s, 0.005);
  EXPECT_EQ(rows[0].iterations, 4);
  EXPECT_EQ(rows[0].threads, 2);
  EXPECT_EQ(rows[0].ms_a_step, 73);
  EXPECT_EQ(rows[0].density_error_percent, 0.61);
  EXPECT_EQ(rows[1].source, "there");
  EXPECT_FALSE(rows[1].iterations || rows[1].threads || rows[1].density_error_percent);
  EXPECT_TRUE(measure::to_json(rows)[1]["density_error_percent"].is_null());
}

TEST_F(Peers, AMalformedFileIsNamedWithItsLine) {
  const std::string good = "A,PBF,32768,0.005,4,cpu,2,73,0.61,somewhere\n";
  EXPECT_THAT(error_of(""), HasSubstr(file + ":1"));
  EXPECT_THAT(error_of("program,ms\n"), HasSubstr(file + ":1"));
  EXPECT_THAT(error_of(head), HasSubstr(file + ":2: the first row of a peer"));
  EXPECT_THAT(error_of(head + good + "\n"), HasSubstr(file + ":3: has 1 cells"));
  for (const auto& [row, name] : std::initializer_list<std::pair<const char*, const char*>>{
           {"A,PBF,32768,0.005,4,cpu,2,73,0.61,some,where", "has 11 cells"},
           {",PBF,32768,0.005,4,cpu,2,73,0.61,x", "program"},
           {"A,PBF,,0.005,4,cpu,2,73,0.61,x", "particles"},
           {"A,PBF,32768,-1,4,cpu,2,73,0.61,x", "dt_s"},
           {"A,PBF,32768,0.005,4.5,cpu,2,73,0.61,x", "iterations"},
           {"A,PBF,32768,0.005,4,cpu,two,73,0.61,x", "threads"},
           {"A,PBF,32768,0.005,4,cpu,2,0,0.61,x", "ms_a_step"},
           {"A,PBF,32768,0.005,4,cpu,2,nan,0.61,x", "ms_a_step"},
           {"A,PBF,32768,0.005,4,cpu,2,73,1 %,x", "density_error_percent"},
           {"A,PBF,32768,0.005,4,cpu,2,73,0.61,", "source"}}) {
    EXPECT_THAT(error_of(head + good + row + "\n"), AllOf(HasSubstr(file + ":3: "), HasSubstr(name))) << row;
  }
}

TEST_F(Peers, TheTableHoldsPeersAndOursWithoutARatio) {
  const auto peers = read(head + "A,DFSPH,32768,0.005,,cpu,2,58,,not recorded\n");
  const std::string table = figures::to_markdown(measure::peers_table(peers, ours_on("Chip X; 2 cores")));
  EXPECT_THAT(table,
              HasSubstr("| A | DFSPH | 32768 | 0.005 | - | cpu | 2 | 58 | - | - | - | not recorded |"));
  EXPECT_THAT(table,
              HasSubstr("| ViP-Lab | PBF | 32768 | 0.005 | 4 | cpu | 2 | 20.5 | 25.25 | 0.125 | 31.5 | "
                        "Chip X; 2 cores |"));
}

TEST_F(Peers, AnotherMachineIsSaidPlainly) {
  const auto peers = read(head + "A,PBF,8,1,,cpu,,1,,on Chip X; 2 cores\n");
  EXPECT_THAT(measure::peers_note(peers, ours_on("Chip X; 2 cores")),
              AllOf(HasSubstr("1.25 substeps"), Not(HasSubstr("one machine only"))));
  EXPECT_THAT(measure::peers_note(peers, ours_on("Chip Y; 2 cores")), HasSubstr("one machine only"));
  EXPECT_THAT(measure::peers_note(peers, ours_on("")), HasSubstr("one machine only"));
}

TEST_F(Peers, OnAGpuThreadsAndMachineAreNotKnown) {
  measure::OurRow ours = measure::our_row({{"particles", 8},
                                           {"backend", "cuda"},
                                           {"threads", 2},
                                           {"solve_ms_mean", 1.0},
                                           {"solve_ms_p95", 1.0},
                                           {"density_error_mean", 0.0},
                                           {"neighbours_mean", 30.0},
                                           {"substeps_mean", 1.0}},
                                          0.005, 4, "");
  EXPECT_FALSE(ours.as_peer.threads);
  EXPECT_THAT(figures::to_markdown(measure::peers_table({}, ours)),
              HasSubstr("| cuda | - | 1 | 1 | 0 | 30 | - |"));
}

class PeersE2e : public ::testing::Test {
 protected:
  test::Ended bench(const std::string& more) const {
    return test::run_shell(
        "env -u DISPLAY " VIP_BIN_DIR "/vip-bench frame --peers --backend cpu --frames 2 " + more);
  }
  ::test::TemporaryFolder folder;
};

TEST_F(PeersE2e, PrintsThePeersAndUs) {
  const std::string json = folder / "p.json";
  const auto ended = bench("--warm-up 0 --json " + json);
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_THAT(ended.out, HasSubstr("| SPlisHSPlasH | PBF | 32768 | 0.005 | 4 | cpu | 2 | 73 |"));
  EXPECT_THAT(ended.out, HasSubstr("| SPlisHSPlasH | DFSPH | 32768 | 0.005 | - | cpu | 2 | 58 | - | - |"));
  EXPECT_THAT(ended.out, HasSubstr("| ViP-Lab | PBF | 32768 | 0.005 | 4 | cpu |"));
  EXPECT_THAT(ended.out, HasSubstr("one machine only"));
  const auto result = base::Json::parse(base::read_file(json, 1 << 20));
  EXPECT_EQ(result["scene"], "PeersDam");
  EXPECT_EQ(result["method"], "HiRes");
  EXPECT_EQ(result["particles"], 32768);
  EXPECT_EQ(result["render_left_out"], "--no-render");
  EXPECT_EQ(result["peers"].size(), 2u);
  EXPECT_FALSE(result["machine"].get<std::string>().empty());
}

TEST_F(PeersE2e, RefusesWhatWouldChangeTheSetting) {
  for (const std::string other : {"data/scenes/peers_dam.toml", "--method HiRes", "--n-star 4k", "--dt 0.005",
                                  "--look", "--iterations 4", "--substeps 1", "--size 64x64", "--views 2",
                                  "--tau fixed:1", "--temporal", "--coarse-cycles 1"}) {
    const auto ended = bench(other);
    EXPECT_EQ(ended.exit_code, 2) << other << ended.out;
    EXPECT_THAT(ended.out, AllOf(HasSubstr("--peers"), HasSubstr("excludes"))) << other;
  }
}

TEST_F(PeersE2e, ABrokenFileIsNamedBeforeTheWork) {
  // A share folder for this test, with a broken file.
  const auto share = folder.path() / "share";
  std::filesystem::create_directories(share / "data");
  base::write_file_atomically(share / "data/peers.csv", head + "A,PBF\n");
  const auto ended =
      test::run_shell("cd '" + folder.path().string() + "' && VIP_SHARE_DIR='" + share.string() +
                      "' " VIP_BIN_DIR "/vip-bench frame --peers --backend cpu");
  EXPECT_EQ(ended.exit_code, 1) << ended.out;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("peers.csv:2: has 2 cells"), HasSubstr("mend:")));
}

}  // namespace
}  // namespace apps
