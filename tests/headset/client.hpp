#pragma once
/// A client program that uses OpenXR correctly, on the simulated runtime through the real loader. Tests make
/// one call or argument of it wrong.

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/headset/openxr.hpp"

namespace simulated {

/// The arguments of xrEndFrame.
struct Drawing {
  XrFrameEndInfo end{};
  XrCompositionLayerProjection projection{};
  std::array<XrCompositionLayerProjectionView, 2> views{};
  std::vector<const XrCompositionLayerBaseHeader*> layers;
};
using Spoil = std::function<void(Drawing&)>;

/// An OpenXR structure with its type set.
template <class T>
T blank(XrStructureType type) {
  T out{};
  out.type = type;
  return out;
}

class Client {
 public:
  /// Connects and makes a session with two swapchains, one per eye. `profile`: value of VIP_XR_PROFILE; the
  /// images have 64 x 48 px unless it sets `size`. `binding`: graphics binding of the current OpenGL context;
  /// null makes an EGL context.
  explicit Client(const std::string& profile = "", const void* binding = nullptr);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void make_session();
  void make_swapchains(std::int64_t format = GL_SRGB8_ALPHA8, std::uint32_t array = 1);

  /// Handles all waiting events: begins the session at READY, ends it at STOPPING, and stores all other
  /// events.
  void poll();
  /// Handles events and runs one frame. Returns the result of xrEndFrame, or of the first call that failed.
  XrResult frame(const Spoil& spoil = {});
  /// Runs frames until the session has that state. The test fails if 100 frames do not suffice.
  void frames_until(XrSessionState state);

  XrResult wait() { return call<PFN_xrWaitFrame>("xrWaitFrame")(session, nullptr, &state); }
  XrResult begin() { return call<PFN_xrBeginFrame>("xrBeginFrame")(session, nullptr); }
  /// Draws both eyes if the frame should render and the head's orientation is valid, applies `spoil` to the
  /// arguments of xrEndFrame, and ends the frame.
  XrResult end(const Spoil& spoil = {});
  /// Acquires, waits for and releases the eye's image, filled with a colour.
  void draw(int eye, const std::array<float, 4>& colour = {0.25f, 0.5f, 0.75f, 1});
  XrResult locate(std::array<XrView, 2>& views, XrViewState& view_state);
  XrSpaceLocation locate(XrSpace what, XrSpace from, XrTime time, void* next = nullptr);
  XrSpace make_space(XrReferenceSpaceType type);

  /// A function of the runtime by its OpenXR name; null if the runtime has no such function.
  template <class F>
  F call(const char* name) const {
    return reinterpret_cast<F>(find(name));
  }

  std::string log() const;
  /// The log lines with this prefix, in order.
  std::vector<std::string> lines(const std::string& start) const;
  std::filesystem::path folder() const { return folder_.path(); }

  std::optional<sim::GlContext> gl;
  XrInstance instance = XR_NULL_HANDLE;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  XrSession session = XR_NULL_HANDLE;
  XrSpace local = XR_NULL_HANDLE;
  std::array<XrSwapchain, 2> swapchains{};
  std::array<std::vector<XrSwapchainImageOpenGLKHR>, 2> images;
  std::uint32_t width = 0, height = 0;
  XrFrameState state = blank<XrFrameState>(XR_TYPE_FRAME_STATE);
  XrSessionState session_state = XR_SESSION_STATE_UNKNOWN;
  std::vector<XrSessionState> states;     ///< all states that were reported
  std::vector<XrEventDataBuffer> events;  ///< all events other than changes of state
  bool running = false;

 private:
  PFN_xrVoidFunction find(const char* name) const;
  void make_instance();

  const test::TemporaryFolder folder_;
  std::string log_;
  const void* binding_;
  XrGraphicsBindingEGLMNDX egl_ = blank<XrGraphicsBindingEGLMNDX>(XR_TYPE_GRAPHICS_BINDING_EGL_MNDX);
};

std::string read_text(const std::filesystem::path& path);

}  // namespace simulated
