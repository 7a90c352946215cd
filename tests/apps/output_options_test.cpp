/// Every option that names an output: if it cannot be written, the command says so and leaves nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/apps/study_test_support.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) names.push_back(entry.path().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// One database with a pilot and a task of pairs.
class OutputOptionsE2e : public ::testing::Test {
 protected:
  OutputOptionsE2e() {
    base::write_file_atomically(folder_ / "file", "mine");
    fs::create_symlink("/dev/full", folder_ / "full");
    make_quick_share(share_.path());
    // The smallest number of people that can be fitted.
    for (const std::string people : {"ptpe_pilot.toml --participants 4 --observer ptpe:a=24,b=0.02",
                                     "task2.toml --participants 2 --observer random"}) {
      const Ended ended = program("vip-study run protocols/" + people + " --seed 7 --db " + database_);
      EXPECT_EQ(ended.exit_code, 0) << ended.out;
    }
    const std::string cell = power_ + " --cell " + first_cell(power_) + " --out " + shard_;
    EXPECT_EQ(program(cell).exit_code, 0) << cell;
  }

  /// Runs a program of the build with its arguments, on one thread and without stored states. It reads its
  /// shared files from `share_`, locks there too, and may take 60 s.
  Ended program(const std::string& program_and_arguments) const {
    return run_shell(
        "cd " + share_.path().string() +
        " && OMP_NUM_THREADS=1 VIP_CACHE_DIR= VIP_LOCK_DIR=. VIP_SHARE_DIR=. timeout 60 " VIP_BIN_DIR "/" +
        program_and_arguments);
  }

  /// The key that the command lists first.
  std::string first_cell(const std::string& command) const {
    return program(command + " --list").out.substr(0, 16);
  }

  /// Commands that end with an option for an output file.
  std::vector<std::string> file_options() const {
    const std::string bench =
        "vip-bench frame data/scenes/single_dam.toml --n-star 64 --frames 1 --no-render";
    return {"vip-study check protocols/demo.toml --refresh 90 --json ",
            "vip-study bake data/scenes/single_dam.toml --n-star 64 --frames 1 --force --out ",
            "vip-study run protocols/demo.toml --observer random --participants 1 --db ",
            "vip-study merge " + database_ + " --into ",
            "vip-study salvage --db " + database_ + " --into ",
            "vip-stats fit-ptpe " + database_ + " --json ",
            "vip-stats fit-ptpe " + database_ + " --svg ",
            "vip-stats fit-ptpe " + database_ + " --force --out ",
            "vip-stats report " + database_ + " --html ",
            "vip-stats report " + database_ + " --html " + page_ + " --json ",
            "vip-stats task2 " + database_ + " --json ",
            "vip-stats scale " + database_ + " --protocol task2 --prior normal --json ",
            power_ + " --json ",
            power_ + " --csv ",
            power_ + " --svg ",
            power_ + " --cell " + first_cell(power_) + " --out ",
            "vip-stats power merge" + power_.substr(power_.find(" protocols")) + " " + shard_ + " --json ",
            bench + " --json ",
            effects_ + " --csv ",
            effects_ + " --markdown ",
            effects_ + " --svg ",
            surface_ + " --csv ",
            surface_ + " --json ",
            growth_ + " --csv ",
            growth_ + " --svg ",
            accuracy_ + " --db ",
            accuracy_ + " --cell " + first_cell(accuracy_) + " --out ",
            accuracy_ + " --db " + sweep_ + " --csv ",
            accuracy_ + " --db " + sweep_ + " --prices-csv ",
            accuracy_ + " --db " + sweep_ + " --markdown ",
            accuracy_ + " --db " + sweep_ + " --html ",
            accuracy_ + " --db " + sweep_ + " --budget 5000ms --out ",
            table1_ + " --csv ",
            table1_ + " --markdown ",
            table1_ + " --cells ",
            table2_ + " --csv ",
            table2_ + " --markdown "};
  }
  std::vector<std::string> folder_options() const {
    return {"vip-study export --db " + database_ + " --csv ",
            "vip-study export --db " + database_ + " --bids ",
            "vip-study export --db " + database_ + " --psych-ds ",
            "vip-stats report " + database_ + " --html " + page_ + " --csv ",
            "vip-stats task2 " + database_ + " --csv ",
            "vip-stats preregister protocols/task2.toml --out ",
            "vip-study check protocols/demo.toml --size 64x36 --preview ",
            table1_ + " --svg ",
            table1_ + " --pictures ",
            surface_ + " --pictures ",
            table1_ + " --checkpoints-to ",
            table2_ + " --svg ",
            "vip-view data/scenes/single_dam.toml --headless --n-star 64 --frames 1 --size 64x36 --png "};
  }

  /// place: text that must be in the error.
  void expect_refused(const std::string& line, const std::string& target, const std::string& place) {
    const auto before = names_in(folder_.path());
    const Ended ended = program(line + target);
    EXPECT_EQ(ended.exit_code, 1) << line << target << "\n" << ended.out;
    EXPECT_THAT(ended.out, AllOf(HasSubstr("error: "), HasSubstr(place), HasSubstr("\n  mend: "))) << line;
    EXPECT_EQ(names_in(folder_.path()), before) << line;
    EXPECT_TRUE(fs::is_character_file(folder_ / "full")) << line;
    EXPECT_EQ(count_in(database_, "SELECT count(*) FROM export"), 0) << line;
  }

  inline static const std::string table1_ =
      "vip-bench table1 --scene SingleDam --n-star 64 --checkpoints 1 --gazes 1 --repeats 1 --frames-after 1 "
      "--cumul-frames 2 --projections 1 --size 64x36";
  inline static const std::string accuracy_ =
      "vip-bench accuracy --quick --n-star 64 --seconds 0.1 --seeds 1 --pictures none";
  inline static const std::string power_ =
      "vip-stats power protocols/task2.toml --n 20:20 --effect 0.7 --studies 10";
  inline static const std::string effects_ =
      "vip-bench effects data/scenes/splash.toml --n-star 64 --frames 1 --warm-up 0";
  inline static const std::string growth_ =
      "vip-bench growth data/scenes/single_dam.toml --n-star 64,65 --frames 1 --warm-up 0";
  inline static const std::string surface_ = "vip-bench surface --surface spheres --n-star 64 --frames 0";
  inline static const std::string table2_ =
      "vip-bench table2 --scene SingleDam --n-star 64 --methods LoRes --frames 2 --warm-up 0";
  const TemporaryFolder folder_, share_;
  const std::string database_ = folder_ / "s.db", sweep_ = folder_ / "sweep.db",
                    page_ = folder_ / "page.html", shard_ = folder_ / "shard.json";
};

TEST_F(OutputOptionsE2e, ThatCannotBeWrittenEndWithPlaceAndMend) {
  const std::string full = folder_ / "full", file = folder_ / "file", below = file + "/out";
  for (const std::string& line : file_options()) {
    expect_refused(line, full, "/full");
    expect_refused(line, below, below);
  }
  for (const std::string& line : folder_options()) {
    expect_refused(line, full, "/full");
    expect_refused(line, below, file);  // missing parents are made: `file` is no folder
  }
}

// Whether the output can be written is checked before the work, while errors in the input are found during
// the work.
TEST_F(OutputOptionsE2e, PlacesAreCheckedBeforeTheWork) {
  base::write_file_atomically(folder_ / "empty", "");
  const std::string input = folder_ / "empty", below = folder_ / "file/out";
  auto all = file_options();
  for (const std::string& line : folder_options()) all.push_back(line);
  int checked = 0;
  for (std::string line : all) {
    for (const std::string& read :
         {database_, std::string("protocols/task2.toml"), std::string("protocols/demo.toml"),
          std::string("data/scenes/single_dam.toml")}) {
      if (const auto at = line.find(read); at != std::string::npos) line.replace(at, read.size(), input);
    }
    // Left out: table1, table2 and surface, which read no input file, and bake, which reads its scene before
    // it checks the output.
    if (line.find(input) == std::string::npos || line.find("bake") != std::string::npos) continue;
    ++checked;
    const Ended ended = program(line + below);
    EXPECT_EQ(ended.exit_code, 1) << line << "\n" << ended.out;
    EXPECT_THAT(ended.out, AllOf(HasSubstr(folder_ / "file"), ::testing::Not(HasSubstr(input)))) << line;
  }
  EXPECT_GT(checked, 20);
}

TEST_F(OutputOptionsE2e, FoldersThatAreMissingAreMade) {
  auto all = file_options();
  for (const std::string& line : folder_options()) all.push_back(line);
  // The tables take long, so each runs once, with all its outputs.
  std::map<std::string, std::string> outputs;  // by command
  std::vector<fs::path> targets;
  for (const std::string& line : all) {
    targets.push_back(folder_ / ("new" + std::to_string(targets.size())) / "deep" / "out");
    const bool table = line.starts_with(table1_) || line.starts_with(table2_) ||
                       line.starts_with(accuracy_) || line.starts_with(surface_);
    const std::size_t option = table ? line.rfind(" --") : line.size();
    outputs[line.substr(0, option)] += line.substr(option) + targets.back().string();
  }
  for (const auto& [command, named] : outputs) {
    const Ended ended = program(command + named);
    EXPECT_EQ(ended.exit_code, 0) << command << named << "\n" << ended.out;
  }
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_TRUE(fs::exists(targets[i])) << all[i];
}

}  // namespace
}  // namespace apps::test
