/// Whole results of Task 1 and Task 2, from the database to the JSON, against R:
/// tests/stats/r/task_studies.R.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/task_database.hpp"

namespace {

using Json = base::Json;
using ::test::TemporaryFolder;
using ::testing::ElementsAre;

const std::vector<std::string> methods{"LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes"};
const std::vector<std::string> scenes{"data/scenes/single_dam.toml", "data/scenes/jet_impact.toml",
                                      "data/scenes/faucet.toml"};
const std::vector<std::string> n_stars{"16k", "32k"};
const std::vector<std::string> questions{"realism", "disorientation", "unrealism", "dizziness", "confusion"};

const Json& made_by_r() {
  static const Json json =
      Json::parse(base::read_file(std::string(VIP_TEST_DIR) + "/stats/r/task_studies.json", 1 << 24));
  return json;
}

std::string code(int person) { return (person < 10 ? "P0" : "P") + std::to_string(person); }

const std::string& item(const std::vector<std::string>& list, const Json& from_one) {
  return list.at(from_one.get<std::size_t>() - 1);
}

/// Rows as the script makes them: person, visit, position, scene, and n_*, method, answers of Task 1 or
/// first, second, chosen of Task 2.
std::vector<task_database::Trial> trials_of(const Json& study, bool pairs) {
  std::vector<task_database::Trial> out;
  for (const Json& row : study.at("rows")) {
    task_database::Trial trial{code(row[0]), row[1], row[2], item(scenes, row[3]), "", "", {}, {}};
    trial.n_star = pairs ? "32k" : item(n_stars, row[4]);
    trial.first = item(methods, pairs ? row[4] : row[5]);
    if (pairs) trial.second = item(methods, row[5]);
    for (std::size_t i = 6; i < row.size(); ++i)
      if (row[i].is_number()) trial.answers[pairs ? "preference" : questions[i - 6]] = row[i];
    out.push_back(trial);
  }
  return out;
}

/// The study whose answers this study uses, or itself.
const Json& answers_of(const Json& study) {
  for (const Json& other : made_by_r().at("studies"))
    if (other.at("name") == study.at("of")) return other;
  return study;
}

/// What vip-stats writes for the study's answers under its plan.
Json results_of(const Json& study) {
  const bool pairs = study.at("task") == 2;
  const std::string task = pairs ? "task2" : "task1";
  const TemporaryFolder folder;
  task_database::write(folder / "study.db",
                       study::read_protocol(base::resource("protocols/" + task + ".toml")),
                       trials_of(answers_of(study), pairs));
  base::write_file_atomically(folder / "plan.toml",
                              "format = 1\nresamples = 100\ndecision = " + study.at("decision").dump() +
                                  "\ndirectional = " + study.at("directional").dump() + "\n");
  const auto ended = apps::test::run_shell(
      VIP_BIN_DIR "/vip-stats " + task + " " + (folder / "study.db").string() + " --plan " +
      (folder / "plan.toml").string() + " --json " + (folder / "out.json").string());
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  return Json::parse(base::read_file(folder / "out.json", 1 << 26));
}

/// Compares R's results with the program's; keeps the names of fields whose numbers were compared.
class Comparison {
 public:
  void compare(const Json& want, const Json& got, const std::string& name, const std::string& place) {
    if (want.is_object()) {
      for (const auto& [key, value] : want.items()) {
        ASSERT_TRUE(got.is_object() && got.contains(key)) << place << " has no " << key << ": " << got.dump();
        compare(value, got.at(key), name + "." + key, place + "/" + key);
      }
    } else if (want.is_array()) {
      ASSERT_TRUE(got.is_array() && got.size() == want.size())
          << place << ": " << got.dump() << " for " << want.dump();
      for (std::size_t i = 0; i < want.size(); ++i)
        compare(want[i], got[i], name, place + "/" + std::to_string(i));
    } else if (want.is_number() && got.is_number()) {
      names.insert(name);
      ++numbers;
      const double r = want, own = got;
      EXPECT_NEAR(own, r, 1e-9 * std::abs(r) + 1e-12) << place;
    } else {
      EXPECT_EQ(got, want) << place;
    }
  }

  std::set<std::string> names;
  int numbers = 0;
};

/// Names of all fields that hold numbers.
void names_of(const Json& json, const std::string& name, std::set<std::string>& names) {
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) names_of(value, name + "." + key, names);
  } else if (json.is_array()) {
    for (const Json& one : json) names_of(one, name, names);
  } else if (json.is_number()) {
    names.insert(name);
  }
}

/// Fields that the script does not compute: bootstrap intervals, whose resamples are the program's own, and
/// models that have their own fixtures or no function in base R (mixed_model.R, tests/stats/oracle).
bool is_left_to_others(const std::string& name) {
  for (const std::string part :
       {".task1.ordinal", ".task1.mixed", ".task1.comparisons.mixed", ".task1.comparisons.tipping",
        ".hypotheses.tests.tipping", ".task1.people", ".bca", ".by_n_star", ".by_scene", ".detectable",
        ".distributions", ".reliability"})
    if (name.find(part) != std::string::npos) return true;
  return false;
}

/// `large`: studies with more than 200 rows; `least`: the minimum number of compared numbers.
void expect_as_r(bool large, int least) {
  constexpr std::size_t most_rows = 200;
  Comparison all;
  std::set<std::string> printed;
  for (const Json& study : made_by_r().at("studies")) {
    if ((answers_of(study).at("rows").size() > most_rows) != large) continue;
    SCOPED_TRACE(study.at("name").get<std::string>());
    const Json got = results_of(study);
    all.compare(study.at("results"), got, "", "");
    for (const char* part : {"task1", "task2", "hypotheses"})
      if (got.contains(part)) names_of(got.at(part), std::string(".") + part, printed);
  }
  EXPECT_GT(all.numbers, least);
  std::set<std::string> only_here;
  for (const auto& name : printed)
    if (!all.names.contains(name) && !is_left_to_others(name)) only_here.insert(name);
  // R does not compute these: they are inputs of the analysis, and counts of answers that decide which test a
  // pair gets. The suites Task2 and ShareTest check the counts.
  EXPECT_THAT(only_here, ElementsAre(".hypotheses.alpha", ".task1.scores.margin", ".task1.scores.max",
                                     ".task1.scores.min", ".task2.choices.position", ".task2.pairs.several",
                                     ".task2.several_answers.most", ".task2.several_answers.of",
                                     ".task2.several_answers.participants"));
}

TEST(TaskStudiesE2e, EveryNumberThatRMakesIsTheSame) { expect_as_r(false, 6000); }

TEST(TaskStudiesSlow, EveryNumberThatRMakesIsTheSame) { expect_as_r(true, 8000); }

}  // namespace
