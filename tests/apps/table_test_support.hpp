#pragma once
/// Helpers for tests of vip-bench's tables.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps::test {

/// One line of a CSV file by the header's names.
using Row = std::map<std::string, std::string>;

/// Makes a folder for VIP_SHARE_DIR: the shipped files, but scenes whose water settles for 120 frames settle
/// for 4. Settling takes nearly all the time of a run of few frames.
inline void make_quick_share(const std::filesystem::path& share) {
  namespace fs = std::filesystem;
  const fs::path shipped = base::resource(""), scenes = fs::path("data") / "scenes";
  const std::string usual = "settle_frames = 120";
  fs::create_directories(share / scenes);
  bool changed = false;
  for (const auto& scene : fs::directory_iterator(shipped / scenes)) {
    std::string text = base::read_file(scene.path(), 1 << 20);
    const std::size_t at = text.find(usual);
    if (at == std::string::npos) continue;
    std::ofstream(share / scenes / scene.path().filename())
        << text.replace(at, usual.size(), "settle_frames = 4");
    changed = true;
  }
  if (!changed) throw std::runtime_error("data/scenes: no scene has " + usual + "; adapt make_quick_share()");
  for (const fs::path& folder : {scenes, fs::path("data"), fs::path()}) {
    for (const auto& entry : fs::directory_iterator(shipped / folder)) {
      const fs::path copy = share / folder / entry.path().filename();
      if (!fs::exists(copy)) fs::create_symlink(entry.path(), copy);
    }
  }
}

/// Runs programs on one thread, without a display and without stored states. Water settles for few frames.
class TableTest : public ::testing::Test {
 protected:
  TableTest() { make_quick_share(share.path()); }
  /// The shell command that runs a program of the build with these arguments. The program reads scenes from
  /// the share. It locks timed runs in the test's own folder, so it does not wait for other tests; no test
  /// asserts a time.
  std::string line_of(const std::string& program_and_arguments) const {
    return "cd " + share.path().string() +
           " && exec env -u DISPLAY -u WAYLAND_DISPLAY OMP_NUM_THREADS=1 VIP_CACHE_DIR= VIP_LOCK_DIR=. "
           "VIP_SHARE_DIR=. " VIP_BIN_DIR "/" +
           program_and_arguments;
  }
  Ended program(const std::string& program_and_arguments) const {
    return run_shell(line_of(program_and_arguments));
  }
  Ended table(const std::string& command_and_arguments) const {
    return program("vip-bench " + command_and_arguments + " --backend cpu");
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
  /// The rows without columns that depend on a clock.
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
  const ::test::TemporaryFolder folder, share;
};

}  // namespace apps::test
