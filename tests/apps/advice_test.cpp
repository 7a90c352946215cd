/// Advice in error texts and notes of the programs: every command and option that they name exists.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::IsEmpty;
using Words = std::set<std::string>;

const fs::path root = fs::path(VIP_TEST_DIR).parent_path();
const std::vector<std::string> programs{"vip-study", "vip-stats", "vip-bench", "vip-view"};

/// The string literals of a source; adjacent ones are joined.
std::vector<std::string> literals_of(const std::string& source) {
  std::vector<std::string> out;
  bool joins = false;  // only white space since the last literal
  for (std::size_t at = 0; at < source.size(); ++at) {
    if (source.compare(at, 2, "//") == 0) {
      at = std::min(source.find('\n', at), source.size());
    } else if (source.compare(at, 3, "'\"'") == 0) {
      at += 2;
      joins = false;
    } else if (source.compare(at, 3, "R\"(") == 0) {
      const std::size_t end = std::min(source.find(")\"", at), source.size());
      out.push_back(source.substr(at + 3, end - at - 3));
      at = end + 1;
      joins = false;
    } else if (source[at] == '"') {
      std::string text;
      for (++at; at < source.size() && source[at] != '"'; ++at) {
        if (source[at] == '\\') ++at;
        text += source[at];
      }
      if (joins) out.back() += text;
      if (!joins) out.push_back(text);
      joins = true;
    } else if (!std::isspace(static_cast<unsigned char>(source[at]))) {
      joins = false;
    }
  }
  return out;
}

/// The options that --help lists, by command ("vip-bench table1"), or by program if it has no commands
/// ("vip-view").
class Programs {
 public:
  Programs() {
    for (const auto& program : programs) {
      const std::string help = help_of(program);
      options_[program] = options_in(help);
      for (const auto& command : commands_in(help)) {
        const std::string whole = program + " " + command;
        const std::string text = help_of(whole);
        options_[whole] = options_in(text);
        for (const auto& inner : commands_in(text))
          options_[whole + " " + inner] = options_in(help_of(whole + " " + inner));
      }
    }
  }

  bool has(const std::string& command) const { return options_.contains(command); }
  bool has(const std::string& command, const std::string& option) const {
    return options_.at(command).contains(option);
  }
  std::vector<std::string> commands_of(const std::string& program) const {
    std::vector<std::string> out;
    for (const auto& [command, options] : options_)
      if (command == program || command.starts_with(program + " ")) out.push_back(command);
    return out;
  }

 private:
  static std::string help_of(const std::string& command) {
    const Ended help = run_shell(VIP_BIN_DIR "/" + command + " --help");
    EXPECT_EQ(help.exit_code, 0) << command << "\n" << help.out;
    return help.out;
  }
  static Words options_in(const std::string& help) {
    static const std::regex option(R"(--[a-z][a-z0-9-]*)");
    return {std::sregex_token_iterator(help.begin(), help.end(), option), std::sregex_token_iterator()};
  }
  static Words commands_in(const std::string& help) {
    static const std::regex entry(R"((?:^|\n)  ([a-z][a-z0-9-]*) )");
    const auto from = help.find("Subcommands:");
    if (from == std::string::npos) return {};
    const std::string list = help.substr(from);
    return {std::sregex_token_iterator(list.begin(), list.end(), entry, 1), std::sregex_token_iterator()};
  }

  std::map<std::string, Words> options_;
};

/// Sources, by the start of their path, and the commands that print their texts. Advice in such a source must
/// be right for each of these commands; advice in any other source, for one of the program's commands.
struct Place {
  std::string path;  ///< start of the path, from the project's root
  std::vector<std::string> commands;
};
const std::vector<Place> shared_places{
    {"libstudy/analysis/task_",
     {"vip-stats report", "vip-stats fit-ptpe", "vip-stats fit-people", "vip-stats task1",
      "vip-stats task2"}},
    {"libstudy/analysis/tasks/scale_", {"vip-stats scale"}},
    {"libstudy/analysis/tasks/", {"vip-stats report", "vip-stats task1", "vip-stats task2"}},
    {"libstudy/analysis/ptpe/people_contours", {"vip-stats fit-people"}},
    {"libstudy/analysis/ptpe/", {"vip-stats fit-ptpe"}},
    {"libstudy/analysis/rivals/", {"vip-stats compare-models"}},
    {"apps/stats/compare_models_command", {"vip-stats compare-models"}},
    {"apps/stats/power", {"vip-stats power"}},
    {"libstudy/power/", {"vip-stats power"}},
    {"apps/stats/fit_ptpe_command", {"vip-stats fit-ptpe"}},
    {"apps/stats/report_command", {"vip-stats report"}},
    {"apps/stats/task_commands", {"vip-stats task1", "vip-stats task2"}},
    {"libstudy/preregistration/freeze", {"vip-stats preregister"}},
    {"apps/study/merge_command", {"vip-study merge"}},
    {"apps/study/export_command", {"vip-study export"}},
    {"apps/study/consent_command", {"vip-study consent"}}};

/// Options of nvidia-smi, which is not one of the project's programs.
const Words of_others{"--query-gpu", "--format"};

/// Words that continue the sentence after a program's name, so that they are not commands.
const Words words_of_sentences{"did", "does", "is", "made", "protocol", "read", "that"};

/// Folders of the libraries that only one program uses, and that program.
const std::map<std::string, std::string> rooms_of_programs{
    {"libsim/measure/", "vip-bench"},           {"libstudy/sweep/run/", "vip-bench"},
    {"libstudy/analysis/", "vip-stats"},        {"libstudy/power/", "vip-stats"},
    {"libstudy/preregistration/", "vip-stats"}, {"libstudy/report/", "vip-stats"},
    {"libstudy/check/", "vip-study"},           {"libstudy/console/", "vip-study"},
    {"libstudy/runner/", "vip-study"}};

std::vector<std::string> own_programs(const std::string& path) {
  for (const auto& [room, program] : rooms_of_programs)
    if (path.starts_with(room)) return {program};
  for (const auto& program : programs)
    if (path.starts_with("apps/" + program.substr(4) + "/")) return {program};
  return programs;
}

/// Errors in the advice of one text; empty if there are none.
std::vector<std::string> wrong_advice(const Programs& known, const std::string& path,
                                      const std::string& text) {
  static const std::regex named(
      R"((vip-(?:study|stats|bench|view))((?: [a-z][a-z0-9-]*)?)|(--[a-z][a-z0-9-]*[a-z0-9]))");
  std::vector<std::string> wrong;
  std::string command;  // the command named last in this sentence
  std::size_t end = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), named), none; at != none; ++at) {
    const auto& match = *at;
    const auto place = static_cast<std::size_t>(match.position());
    const std::string between = text.substr(end, place - end);
    if (between.find_first_of(";:()") != std::string::npos || between.find(". ") != std::string::npos)
      command.clear();
    end = place + static_cast<std::size_t>(match.length());
    const std::string program = match[1], option = match[3];
    if (!program.empty()) {
      const std::string word = match[2], whole = program + word;
      command = known.has(whole) ? whole : program;
      if (command == program && !word.empty() && !words_of_sentences.contains(word.substr(1)))
        wrong.push_back(path + ": " + program + " has no command" + word + ": " + text);
      continue;
    }
    if (of_others.contains(option)) continue;
    if (!command.empty() && known.commands_of(command).size() == 1) {
      if (!known.has(command, option))
        wrong.push_back(path + ": " + command + " has no " + option + ": " + text);
      continue;
    }
    const auto shared = std::find_if(shared_places.begin(), shared_places.end(),
                                     [&](const Place& one) { return path.starts_with(one.path); });
    if (command.empty() && shared != shared_places.end()) {
      for (const auto& one : shared->commands)
        if (!known.has(one, option)) wrong.push_back(path + ": " + one + " has no " + option + ": " + text);
      continue;
    }
    const auto of = command.empty() ? own_programs(path) : std::vector<std::string>{command};
    const bool any = std::any_of(of.begin(), of.end(), [&](const std::string& one) {
      const auto commands = known.commands_of(one);
      return std::any_of(commands.begin(), commands.end(),
                         [&](const std::string& each) { return known.has(each, option); });
    });
    if (!any) wrong.push_back(path + ": no command has " + option + ": " + text);
  }
  return wrong;
}

const Programs& known_programs() {
  static const Programs known;
  return known;
}

TEST(AdviceE2e, NamesOptionsThatThereAre) {
  std::vector<std::string> wrong;
  std::size_t texts = 0;
  for (const char* folder : {"apps", "libstudy", "libsim", "stats"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string kind = entry.path().extension();
      if (kind != ".cpp" && kind != ".hpp") continue;
      for (const auto& text : literals_of(base::read_file(entry.path(), 1 << 20))) {
        if (text.find("--") == std::string::npos && text.find("vip-") == std::string::npos) continue;
        ++texts;
        const auto some = wrong_advice(known_programs(), fs::relative(entry.path(), root).string(), text);
        wrong.insert(wrong.end(), some.begin(), some.end());
      }
    }
  }
  EXPECT_GT(texts, 200u);
  EXPECT_THAT(wrong, IsEmpty());
}

TEST(AdviceE2e, AnOptionThatIsNotThereWouldBeSeen) {
  const auto wrong = [](const char* path, const char* text) {
    return wrong_advice(known_programs(), path, text).size();
  };
  EXPECT_EQ(wrong("libstudy/analysis/task_choice.cpp", "choose one with --protocol"), 0u);
  EXPECT_EQ(wrong("libstudy/analysis/task_choice.cpp", "choose one with --exclude"), 3u);
  EXPECT_EQ(wrong("apps/study/run_command.cpp", "use --no-such-option"), 1u);
  EXPECT_EQ(wrong("stats/base/file.cpp", "use vip-study export --fmt"), 1u);
  EXPECT_EQ(wrong("stats/base/file.cpp", "restore it by vip-study recover"), 1u);
  EXPECT_EQ(wrong("stats/base/file.cpp", "another vip-study is running"), 0u);
  EXPECT_EQ(literals_of("f(\"use --no\" // a comment\n \"-such\", x, \"b\")"),
            (std::vector<std::string>{"use --no-such", "b"}));
}

/// A pilot of six settings with a second question and this version.
std::string two_questions(const std::string& version) {
  return with_before(replaced(with_keys(short_protocol("1"), {{"version", '"' + version + '"'}}),
                              "\"ask satisfaction\"", "\"ask satisfaction smoothness\""),
                     "[[block.question]]\nid = \"satisfaction\"",
                     "[[block.question]]\nid = \"smoothness\"\nkind = \"scale\"\ntext = \"How "
                     "smooth?\"\nscale = [0, 3]\n\n");
}

/// Items of the list after `advice`, up to the end of the line.
std::vector<std::string> listed(const std::string& out, const std::string& advice) {
  const auto at = out.find(advice);
  if (at == std::string::npos) return {};
  const auto from = at + advice.size();
  const std::string list = out.substr(from, out.find('\n', from) - from);
  static const std::regex item(R"([^,]+)");
  return {std::sregex_token_iterator(list.begin(), list.end(), item), std::sregex_token_iterator()};
}

std::string last_word(const std::string& text) { return text.substr(text.find_last_of(' ') + 1); }

// Follows the advice with each of the listed choices.
TEST(AdviceE2e, ChoosingAsAdvisedIsTaken) {
  const TemporaryFolder folder;
  const auto at = [&](const std::string& name) { return (folder / name).string(); };
  for (const char* version : {"3.0", "3.1"}) {
    base::write_file_atomically(folder / "p.toml", two_questions(version));
    const auto ran = run_shell(vip_study + " run " + at("p.toml") + " --db " + at("s.db") +
                               " --participants 6 --observer ptpe:a=24,b=0.02");
    ASSERT_EQ(ran.exit_code, 0) << ran.out;
  }
  const std::string fit = VIP_BIN_DIR "/vip-stats fit-ptpe " + at("s.db") + " --json " + at("fit.json");
  const std::string report = VIP_BIN_DIR "/vip-stats report " + at("s.db") + " --json " + at("report.json");
  const auto no_question = run_shell(fit + " --question nosuch").out;
  EXPECT_EQ(no_question.find("'nosuch'"), no_question.rfind("'nosuch'")) << "one reason: " << no_question;
  const auto protocols = listed(run_shell(fit).out, "choose one with --protocol: ");
  ASSERT_EQ(protocols.size(), 2u);
  for (const auto& protocol : protocols) {
    const std::string whole = protocol.substr(protocol.find_first_not_of(' '));  // "pilot 3.0 0123456789ab"
    for (const std::string& by : {whole, whole.substr(0, whole.find_last_of(' '))})
      EXPECT_NE(run_shell(fit + " --protocol '" + by + "'").out.find("choose one with --question"),
                std::string::npos)
          << by;
    const std::string chosen = fit + " --protocol " + last_word(protocol);
    const auto questions = listed(run_shell(chosen).out, "choose one with --question: ");
    ASSERT_EQ(questions.size(), 2u);
    for (const auto& question : questions) {
      const auto ended = run_shell(chosen + " --question " + last_word(question));
      EXPECT_EQ(ended.out.find("choose one"), std::string::npos) << ended.out;
      EXPECT_TRUE(fs::exists(folder / "fit.json"));
      const auto outside = run_shell(chosen + " --question " + last_word(question) + " --level 9");
      EXPECT_EQ(outside.exit_code, 1);
      EXPECT_NE(outside.out.find("choose a --level above "), std::string::npos) << outside.out;
      EXPECT_NE(outside.out.find("no fit of " + protocol.substr(protocol.find_first_not_of(' '), 4)),
                std::string::npos)
          << "which protocol is said: " << outside.out;
      const auto page = run_shell(report + " --protocol " + last_word(protocol) + " --level 9");
      EXPECT_EQ(page.exit_code, 1) << "as fit-ptpe";
      EXPECT_NE(page.out.find("choose a --level above "), std::string::npos) << page.out;
    }
  }
  // vip-stats power uses one of the questions, and names the other.
  const auto power = run_shell(VIP_BIN_DIR "/vip-stats power " + at("p.toml") + " --n 6 --studies 2");
  EXPECT_EQ(power.exit_code, 0) << power.out;
  EXPECT_NE(power.out.find("choose it with --question "), std::string::npos) << power.out;
  // Without output files each protocol and question is fitted separately.
  const auto all = run_shell(VIP_BIN_DIR "/vip-stats fit-ptpe " + at("s.db"));
  for (const char* words : {"3.0, question \"satisfaction\":", "3.1, question \"smoothness\":"})
    EXPECT_NE(all.out.find(words), std::string::npos) << all.out;
}

}  // namespace
}  // namespace apps::test
