/// The commands that README.md and docs/ name, against the programs' --help.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"

namespace apps::test {
namespace {

namespace fs = std::filesystem;
using ::testing::SizeIs;
using Lines = std::vector<std::string>;

const fs::path root = fs::path(VIP_TEST_DIR).parent_path();

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

Lines page(const fs::path& path) { return lines_of(base::read_file(path, 1 << 20)); }

std::string help_of(const std::string& command) {
  const Ended help = run_shell(VIP_BIN_DIR "/" + command + " --help");
  EXPECT_EQ(help.exit_code, 0) << command << "\n" << help.out;
  return help.out;
}

/// The commands that `program` lists, like "vip-study check"; the program itself if it has no subcommands.
Lines commands_of(const std::string& program) {
  static const std::regex entry(R"(^  ([a-z][a-z0-9-]*) .*)");
  Lines commands;
  bool listed = false;
  std::smatch match;
  for (const std::string& line : lines_of(help_of(program))) {
    if (line == "Subcommands:") listed = true;
    if (listed && std::regex_match(line, match, entry)) commands.push_back(program + " " + match[1].str());
  }
  return commands.empty() ? Lines{program} : commands;
}

/// The commands in the rows of the table of docs/commands.md, without their arguments (capital letters).
Lines commands_in_table() {
  static const std::regex row(R"(^\| `(vip-[a-z]+( [a-z][a-z0-9-]*)?)[ `].*)");
  Lines commands;
  std::smatch match;
  for (const std::string& line : page(root / "docs/commands.md")) {
    if (std::regex_match(line, match, row)) commands.push_back(match[1]);
  }
  return commands;
}

TEST(ReadmeE2e, TheTableNamesEveryCommandOnce) {
  Lines all;
  for (const char* program : {"vip-study", "vip-stats", "vip-bench", "vip-view"}) {
    const Lines some = commands_of(program);
    all.insert(all.end(), some.begin(), some.end());
  }
  EXPECT_THAT(commands_in_table(), ::testing::UnorderedElementsAreArray(all));
}

/// The command lines of a page's fenced blocks, with their continuation lines.
Lines command_lines(const fs::path& path) {
  Lines found;
  bool fenced = false, goes_on = false;
  for (std::string line : page(path)) {
    if (line.starts_with("```")) fenced = !fenced;
    if (!goes_on && !(fenced && line.starts_with("vip-"))) continue;
    const bool more = line.ends_with('\\');
    if (more) line.pop_back();
    if (goes_on) {
      found.back() += line;
    } else {
      found.push_back(line);
    }
    goes_on = more;
  }
  return found;
}

std::string without_comment(const std::string& line) { return line.substr(0, line.find('#')); }

TEST(ReadmeE2e, EveryOptionOfACommandLineExists) {
  static const std::regex head(R"(^(vip-view|vip-[a-z]+ [a-z][a-z0-9-]*))"), option(R"(--[a-z][a-z0-9-]*)");
  std::vector<fs::path> pages{root / "README.md"};
  for (const auto& entry : fs::directory_iterator(root / "docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  std::map<std::string, std::string> helps;
  for (const fs::path& path : pages) {
    for (const std::string& line : command_lines(path)) {
      std::smatch command;
      ASSERT_TRUE(std::regex_search(line, command, head)) << path << ": " << line;
      std::string& help = helps[command[1]];
      if (help.empty()) help = help_of(command[1]);
      const std::string words = without_comment(line);
      for (std::sregex_iterator at(words.begin(), words.end(), option), end; at != end; ++at) {
        EXPECT_TRUE(std::regex_search(help, std::regex(at->str() + "[ ,]"))) << path << ": " << line;
      }
    }
  }
  EXPECT_FALSE(helps.empty());
}

/// The README fits into a terminal.
TEST(Readme, LinesHoldAHundredColumns) {
  for (const std::string& line : page(root / "README.md")) EXPECT_THAT(line, SizeIs(::testing::Le(100)));
}

/// Tables, pictures and protocol.md, which vip-study writes, may have longer lines.
TEST(Docs, ProseHoldsAHundredAndTenColumns) {
  for (const auto& entry : fs::directory_iterator(root / "docs")) {
    if (entry.path().extension() != ".md" || entry.path().filename() == "protocol.md") continue;
    for (const std::string& line : page(entry.path())) {
      if (line.starts_with("|") || line.starts_with("![")) continue;
      EXPECT_THAT(line, SizeIs(::testing::Le(110))) << entry.path();
    }
  }
}

}  // namespace
}  // namespace apps::test
