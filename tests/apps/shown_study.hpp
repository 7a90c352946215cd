#pragma once
/// A small study with stimuli shown live or from bakes, on the virtual clock.

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {

/// Runs the programs on a protocol that the test writes, with pictures of `size`.
class ShownStudy : public ::testing::Test {
 protected:
  ShownStudy(const std::string& name, std::string size)
      : protocol_(folder_ / (name + ".toml")), size_(std::move(size)) {}

  Ended run(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{vip_study, "run",       protocol_, "--db",      database_,
                                       "--size",  size_,       "--clock", "virtual",   "--observer",
                                       "random",  "--backend", "cpu",     "--display", "headless"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  Ended bake(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{vip_study, "bake",   "--protocol", protocol_,   "--out",
                                       bakes_,    "--size", size_,        "--backend", "cpu"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  /// The stimulus recorded for the last session.
  std::string stimulus() const {
    return study::sqlite::Connection(database_, study::sqlite::Open::Read)
        .text("SELECT stimulus FROM session ORDER BY session_id DESC LIMIT 1");
  }

  TemporaryFolder folder_;
  const std::string protocol_, size_, database_ = folder_ / "study.db", bakes_ = folder_ / "bakes";
};

}  // namespace apps::test
