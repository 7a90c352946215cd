#pragma once
/// Reads gaze, buttons and pointing (HeadsetInput) through OpenXR's actions.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "libstudy/headset/headset_session.hpp"
#include "libstudy/headset/loader.hpp"
#include "libstudy/headset/session_handle.hpp"

namespace study {

/// Extensions that kinds of controllers need. They are enabled where the runtime offers them.
std::vector<std::string> controller_extensions();

/// OpenXR's actions of one session. The constructor makes the actions, suggests their bindings, attaches them
/// to the session and makes the spaces of their poses. The specification requires suggestions before the
/// attachment.
class Actions {
 public:
  Actions(const SessionHandle& session, RuntimeClock& clock, bool eye_gaze);
  ~Actions();
  Actions(const Actions&) = delete;
  Actions& operator=(const Actions&) = delete;

  /// Synchronises the actions with the runtime and sets out.focused. If out.focused is true, also reads gaze
  /// and hands at `time` into `out`, with poses in `world`. Call read() only in the state Focused.
  void read(const Space& world, XrTime time, HeadsetInput& out);

 private:
  void make_actions(bool eye_gaze);
  void suggest(bool eye_gaze) const;
  void attach() const;
  bool sync() const;
  XrActionStateGetInfo ask(XrAction action, XrPath hand = XR_NULL_PATH) const;
  bool is_active(XrAction pose, XrPath hand = XR_NULL_PATH) const;
  XrActionStateBoolean read_button(XrAction action) const;
  std::optional<HeadsetGaze> read_gaze(const Space& world, XrTime time);
  HeadsetHands read_hands(const Space& world, XrTime time) const;

  const SessionHandle& session_;
  RuntimeClock& clock_;
  std::array<XrPath, 2> hands_{};
  XrActionSet set_ = XR_NULL_HANDLE;
  XrAction gaze_ = XR_NULL_HANDLE, select_ = XR_NULL_HANDLE, menu_ = XR_NULL_HANDLE, stick_ = XR_NULL_HANDLE,
           aim_ = XR_NULL_HANDLE;
  std::vector<Space> aims_;
  std::unique_ptr<Space> gaze_space_;
};

}  // namespace study
