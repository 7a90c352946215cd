#pragma once
/// What tests of vip-bench's tables share.

#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps::test {

/// One line of a CSV file by its head.
using Row = std::map<std::string, std::string>;

/// vip-bench table1 or table2 on the CPU, without a display or kept states.
class TableTest : public ::testing::Test {
 protected:
  Ended table(const std::string& command_and_arguments) const {
    return run_shell("env -u DISPLAY VIP_CACHE_DIR= " VIP_BIN_DIR "/vip-bench " + command_and_arguments +
                     " --backend cpu");
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::vector<Row> rows(const std::string& name) const {
    std::istringstream lines(base::read_file(path(name), 1 << 16));
    std::string line;
    std::getline(lines, line);
    const auto head = cells(line);
    std::vector<Row> out;
    while (std::getline(lines, line)) {
      const auto values = cells(line);
      EXPECT_EQ(values.size(), head.size());
      Row row;
      for (std::size_t i = 0; i < head.size(); ++i) row[head[i]] = values[i];
      out.push_back(row);
    }
    return out;
  }
  /// Without what a clock gave.
  std::vector<Row> timeless(const std::string& name) const {
    auto out = rows(name);
    for (auto& row : out) {
      std::erase_if(row, [](const auto& cell) {
        return cell.first.find("ms") != std::string::npos || cell.first == "free" || cell.first == "tau";
      });
    }
    return out;
  }
  static std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> out;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) out.push_back(cell);
    return out;
  }
  ::test::TemporaryFolder folder;
};

}  // namespace apps::test
