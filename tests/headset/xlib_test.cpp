/// Sessions with the Xlib binding, the only one that Khronos' validation layer accepts, and the layer's
/// messages.
#include <gmock/gmock.h>

#include <filesystem>
#include <regex>

#include "libsim/gl/png.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/headset/client.hpp"
#include "tests/headset/x_screen.hpp"

namespace simulated {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* layer = "XR_APILAYER_LUNARG_core_validation";

/// While the object lives, OpenXR instances are made with the validation layer, which writes to file().
struct Validation {
  Validation() {
    ::setenv("XR_ENABLE_API_LAYERS", layer, 1);
    ::setenv("XR_CORE_VALIDATION_EXPORT_TYPE", "text", 1);
    ::setenv("XR_CORE_VALIDATION_FILE_NAME", file().c_str(), 1);
  }
  ~Validation() {
    for (const char* name :
         {"XR_ENABLE_API_LAYERS", "XR_CORE_VALIDATION_EXPORT_TYPE", "XR_CORE_VALIDATION_FILE_NAME"})
      ::unsetenv(name);
  }
  Validation(const Validation&) = delete;
  Validation& operator=(const Validation&) = delete;
  std::string file() const { return folder_ / "validation.txt"; }
  std::string says() const { return read_text(file()); }

 private:
  const test::TemporaryFolder folder_;
};

void whole_session(Client& client) {
  client.frames_until(XR_SESSION_STATE_FOCUSED);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(client.frame(), XR_SUCCESS);
  client.call<PFN_xrRequestExitSession>("xrRequestExitSession")(client.session);
  client.poll();
  EXPECT_EQ(client.session_state, XR_SESSION_STATE_EXITING);
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
}

TEST(XlibGl, ACorrectProgramRunsAndIsShown) {
  const XScreen screen;
  Client client("dump=6", &screen.binding());
  whole_session(client);
  EXPECT_EQ(sim::read_png(client.folder() / "000006_left.png").rgba[2], 191);
}

TEST(XlibGl, TheValidationLayerIsSilentOverAWholeSession) {
  const XScreen screen;
  const Validation validation;
  {
    Client client("", &screen.binding());
    whole_session(client);
  }
  EXPECT_THAT(validation.says(), IsEmpty());
}

TEST(XlibGl, TheValidationLayerSpeaksOnAStaleHandle) {
  const XScreen screen;
  const Validation validation;
  {
    Client client("", &screen.binding());
    client.frames_until(XR_SESSION_STATE_FOCUSED);
    const XrSpace stale = client.make_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
    client.call<PFN_xrDestroySpace>("xrDestroySpace")(stale);
    EXPECT_TRUE(XR_FAILED(client.frame([&](Drawing& d) { d.projection.space = stale; })));
  }
  EXPECT_THAT(validation.says(), HasSubstr("xrEndFrame]: Invalid XrSpace handle"));
}

/// vip-study on a runtime without EGL, checked by the validation layer.
class XlibProgramGl : public ::testing::Test {
 protected:
  apps::test::Ended run(const std::string& profile, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), bin + "/vip-study");
    return apps::test::run_program(arguments, [&] {
      ::setenv("DISPLAY", screen_.name().c_str(), 1);
      ::setenv("XR_LOADER_DEBUG", "none", 1);
      ::setenv("XR_RUNTIME_JSON", (bin + "/simulated_headset.json").c_str(), 1);
      ::setenv("VIP_XR_PROFILE", ("size=32x32;without=XR_MNDX_egl_enable;" + profile).c_str(), 1);
      ::setenv("VIP_XR_LOG", log().c_str(), 1);
    });
  }
  std::string log() const { return folder_ / "calls.log"; }

  const std::string bin = VIP_BIN_DIR;
  const test::TemporaryFolder folder_;
  const XScreen screen_;
  const Validation validation_;
};

/// The validation layer may be older than this extension, and speaks then.
const std::string without_newer = "without=XR_EXT_user_presence;";

TEST_F(XlibProgramGl, ShowsATestSceneAndTheValidationLayerIsSilent) {
  const auto ended = run(without_newer, {"headset", "--show", "1"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("frames      92, 91 with pictures"));
  EXPECT_THAT(ended.err, HasSubstr("Core Validation"));  // the layer was active
  EXPECT_THAT(read_text(log()), ::testing::Not(HasSubstr("BREACH")));
  EXPECT_FALSE(std::filesystem::exists(validation_.file())) << validation_.says();
}

TEST_F(XlibProgramGl, ADriverWithoutOpenGl45IsAnErrorOfOurs) {
  ::setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
  const auto ended = run("", {"headset", "--show", "1"});
  ::unsetenv("MESA_GL_VERSION_OVERRIDE");
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("OpenGL: no OpenGL 4.5 core context on the X display"));
  EXPECT_THAT(ended.err, ::testing::Not(HasSubstr("X Error")));
}

TEST_F(XlibProgramGl, PlaysAWholeSessionOnBothClocksAndTheValidationLayerIsSilent) {
  std::string pilot = read_text(base::resource("protocols/ptpe_pilot.toml"));
  pilot = std::regex_replace(pilot, std::regex("mean_fps = .*"), "mean_fps = [5, 10]");
  pilot = std::regex_replace(pilot, std::regex("sd_fps = .*"), "sd_fps = [0]");
  pilot = std::regex_replace(pilot, std::regex("n_star = .*"), "n_star = [\"64\"]");
  base::write_file_atomically(folder_ / "pilot.toml", pilot);
  for (const std::string clock : {"virtual", "real"}) {
    const auto ended =
        run(without_newer + "rates=20;rate=20;clock=" + clock,
            {"run", folder_ / "pilot.toml", "--db", folder_ / (clock + ".db"), "--observer", "random",
             "--display", "openxr", "--clock", clock, "--participants", "1", "--trial-seconds", "1"});
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("2 of 2 trials answered"));
    EXPECT_THAT(read_text(log()), ::testing::Not(HasSubstr("BREACH")));
    EXPECT_FALSE(std::filesystem::exists(validation_.file())) << validation_.says();
  }
}

}  // namespace
}  // namespace simulated
