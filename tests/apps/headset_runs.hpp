#pragma once
/// Runs vip-study and other programs on the simulated runtime of tests/headset, through the real loader.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "libsim/gl/png.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/protocols.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps::test {

using namespace ::test;

class HeadsetRuns : public ::testing::Test {
 protected:
  using Environment = std::vector<std::pair<std::string, std::string>>;

  Ended run(const std::vector<std::string>& arguments, const Environment& environment) {
    std::vector<std::string> all{bin + "/vip-study"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run_any(all, environment);
  }
  /// Runs any program on the simulated runtime.
  Ended run_program_in_headset(const std::vector<std::string>& all, const std::string& profile) {
    return run_any(all, {{"XR_RUNTIME_JSON", bin + "/simulated_headset.json"}, {"VIP_XR_PROFILE", profile}});
  }
  Ended run_any(const std::vector<std::string>& all, const Environment& environment) {
    return run_program(all, [&] { prepare(environment); });
  }
  /// Runs in the child before the program is loaded.
  void prepare(const Environment& environment) const {
    for (const char* name :
         {"XR_RUNTIME_JSON", "VIP_OPENXR_LOADER", "XR_API_LAYER_PATH", "XR_ENABLE_API_LAYERS", "DISPLAY"})
      ::unsetenv(name);
    ::setenv("VIP_XR_LOG", log().c_str(), 1);
    ::setenv("VIP_XR_DUMP", folder_.path().c_str(), 1);
    ::setenv("XR_LOADER_DEBUG", "none", 1);
    // Rates and settled water that another run stored would let this run skip its measurements.
    ::setenv("VIP_CACHE_DIR", (folder_ / "cache").c_str(), 1);
    for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
  }
  /// The environment of the simulated headset with this profile.
  Environment simulated(const std::string& profile) const {
    return {{"XR_RUNTIME_JSON", bin + "/simulated_headset.json"}, {"VIP_XR_PROFILE", profile}};
  }
  /// Runs vip-study headset on the simulated runtime, which must find no breach of the specification.
  Ended on(const std::string& profile, std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.begin(), "headset");
    return study(profile, arguments);
  }
  /// Runs any command of vip-study on the simulated runtime, which must find no breach of the specification.
  Ended study(const std::string& profile, const std::vector<std::string>& arguments) {
    std::filesystem::remove(log());
    Ended ended = run(arguments, simulated(profile));
    EXPECT_THAT(calls(), ::testing::Not(::testing::HasSubstr("BREACH")));
    return ended;
  }
  /// Bakes particles of a small dam break.
  void bake_dam(const std::string& out, int frames) {
    const auto baked =
        run_program({bin + "/vip-study", "bake", "data/scenes/single_dam.toml", "--method", "HiRes",
                     "--n-star", "64", "--frames", std::to_string(frames), "--out", out});
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
  }
  /// Sets the environment for a test that uses the simulated headset, with this profile, in its own process.
  void use_here(const std::string& profile) const {
    ::setenv("XR_RUNTIME_JSON", (bin + "/simulated_headset.json").c_str(), 1);
    ::setenv("XR_LOADER_DEBUG", "none", 1);
    ::setenv("VIP_XR_PROFILE", profile.c_str(), 1);
    ::setenv("VIP_XR_LOG", log().c_str(), 1);
    ::setenv("VIP_XR_DUMP", folder_.path().c_str(), 1);
  }
  std::string log() const { return folder_ / "calls.log"; }
  std::string calls() const { return std::filesystem::exists(log()) ? base::read_file(log(), 1 << 24) : ""; }
  /// The image of a dumped frame for an eye, "left" or "right".
  sim::Image picture(long frame, const std::string& eye) const {
    std::string number = std::to_string(frame);
    number.insert(0, 6 - number.size(), '0');
    return sim::read_png(folder_ / (number + "_" + eye + ".png"));
  }

  const std::string bin = VIP_BIN_DIR;
  const TemporaryFolder folder_;
};

}  // namespace apps::test
