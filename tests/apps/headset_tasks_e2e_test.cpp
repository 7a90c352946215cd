/// Tasks 1 and 2 in the simulated headset, with the smallest live fluid.
#include <sstream>

#include "tests/apps/headset_runs.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class HeadsetTasksE2e : public test::HeadsetRuns {
 protected:
  /// A shipped protocol with few particles, short pauses and, if given, only these methods.
  std::string shortened(const std::string& name, const std::vector<std::string>& methods = {}) {
    std::istringstream lines(base::read_file(base::find_input("protocols/" + name + ".toml"), 1 << 20));
    std::string text;
    for (std::string line; std::getline(lines, line);) {
      const auto names = [&](const std::string& method) {
        return line.find("method = \"" + method + "\"") != std::string::npos;
      };
      const bool moment = line.find("mean_fps =") != std::string::npos;
      if (moment && !methods.empty() && std::none_of(methods.begin(), methods.end(), names)) continue;
      if (line.starts_with("method = ") && !methods.empty()) line = "method = " + list(methods);
      for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
               {"\"16k\"", "\"64\""},
               {"\"32k\"", "\"128\""},
               {"black 5", "black 0.5"},
               {"rest 30", "rest 1"},
               {"rest 60", "rest 1"},
               {"between_groups_s = 120", "between_groups_s = 1"},
               {"seconds = 5", "seconds = 1"}}) {
        for (auto at = line.find(from); at != std::string::npos; at = line.find(from))
          line.replace(at, from.size(), to);
      }
      text += line + "\n";
    }
    base::write_file_atomically(folder_ / (name + ".toml"), text);
    return folder_ / (name + ".toml");
  }

  static std::string list(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "[\"" : "\", \"") + word;
    return out + "\"]";
  }

  test::Ended session(const std::string& profile, const std::string& protocol,
                      const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "run",     protocol, "--db",  folder_ / "study.db", "--display", "openxr", "--clock",
        "virtual", "--gaze", "fixed", "--trial-seconds",    "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return study("size=32x32;" + profile, arguments);
  }
};

TEST_F(HeadsetTasksE2e, Task1RunsFromConsentToThanks) {
  const auto ended =
      session("head=walk", shortened("task1"), {"--participants", "1", "--observer", "random"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("10 of 10 trials answered"));
}

TEST_F(HeadsetTasksE2e, Task2RunsFromConsentToThanks) {
  const auto ended =
      session("head=walk", shortened("task2"), {"--participants", "1", "--observer", "random"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("10 of 10 trials answered"));
}

/// The scripted hand presses targets from the top of a page down to its button, so the lower of the two
/// choices is selected last.
TEST_F(HeadsetTasksE2e, APairIsAnsweredByARay) {
  std::string targets = "targets=0.5:0.26";
  for (int y = 30; y < 92; y += 4) targets += ",0.5:0." + std::to_string(y);
  const auto ended = session("point=page;hold=0.3;at=8000:exit;" + targets,
                             shortened("task2", {"LoRes", "HiRes"}), {"--participant", "P01"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("1 of 1 trials answered"));
  EXPECT_THAT(ended.out, HasSubstr("showings: 2, 2 of them count"));
}

}  // namespace
}  // namespace apps
