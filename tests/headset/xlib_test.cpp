/// Sessions by the binding to Xlib, which is the one that Khronos' validation layer takes, and what that
/// layer says.
#include <gmock/gmock.h>

#include "libsim/render/png.hpp"
#include "tests/headset/client.hpp"
#include "tests/headset/x_screen.hpp"

namespace simulated {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* layer = "XR_APILAYER_LUNARG_core_validation";

/// The validation layer on, for the instances that are made meanwhile.
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

}  // namespace
}  // namespace simulated
