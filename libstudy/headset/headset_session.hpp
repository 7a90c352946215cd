#pragma once
/// An OpenXR session in a headset, and its frames (slots).

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libstudy/headset/rate_meter.hpp"
#include "libstudy/headset/views.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

/// The states of a session in OpenXR's specification.
enum class HeadsetState {
  Unknown,
  Idle,
  Ready,         ///< the session begins to run frames
  Synchronized,  ///< frames run, but pictures are not visible
  Visible,       ///< pictures are visible, without input from controllers and eyes
  Focused,
  Stopping,     ///< frames stop: the headset was taken off, or the session ends
  LossPending,  ///< the session will be lost; a new one can be made
  Exiting,      ///< the session must end, and no new one may start by itself
};

/// The name of a state, such as "focused".
const char* name_of(HeadsetState state);

struct HeadsetEvent {
  enum class Kind {
    State,        ///< `state` was entered
    RuntimeEnds,  ///< the OpenXR runtime shuts down at `at_ns`
    Refresh,      ///< the refresh rate changed from `from_hz` to `to_hz`
    Recentred,    ///< the world's origin moves at `at_ns`
    Presence,     ///< the headset was put on (`worn`) or taken off
    EventsLost,   ///< some events were dropped
    Lost,         ///< the session is gone; no slots come until MadeAnew
    MadeAnew,     ///< a new session replaces a lost one
  };
  Kind kind = Kind::State;
  HeadsetState state = HeadsetState::Unknown;
  double from_hz = 0, to_hz = 0;
  std::int64_t at_ns = -1;  ///< time on the session's clock; -1: not reported
  bool worn = true;         ///< somebody wears the headset
};

/// The gaze ray of both eyes together. It starts at ray.place_m and has the direction direction_of(ray).
struct HeadsetGaze {
  /// Time of the sample on the session's clock; none if the runtime does not report it.
  std::optional<std::int64_t> sampled_ns;
  /// Time of the sample on the clock of an eye tracker outside OpenXR; none: the runtime's tracker.
  std::optional<std::int64_t> device_ns{};
  HeadsetPose ray;  ///< an orientation that is valid but not tracked is an estimate of the runtime
};

/// Buttons and pointing of both hands. A button held on both hands counts once.
struct HeadsetHands {
  bool select = false;           ///< the select button is pressed
  bool select_began = false;     ///< pressed since the last input(), and still pressed
  bool menu = false;             ///< the menu button is pressed
  std::array<float, 2> stick{};  ///< deflection of the thumbstick right and up, [-1, 1]; 0 without a stick
  /// Pose of the left and the right hand, which point along direction_of(pose); none: not active.
  std::array<std::optional<HeadsetPose>, 2> aim;
};

/// The participant's input: gaze, head pose, buttons and pointing.
struct HeadsetInput {
  HeadsetPose head;
  bool focused = false;             ///< the session has the input focus; gaze and hands are set only then
  std::optional<HeadsetGaze> gaze;  ///< none: no tracker, or no data now
  HeadsetHands hands;
};

struct HeadsetChoice {
  bool eye_gaze = false;  ///< requests eye tracking; needs the participant's consent
  /// Requests reports of whether somebody wears the headset (XR_EXT_user_presence), where they are offered.
  bool user_presence = true;
  double patience_s = 10;  ///< longest wait for a frame, an image or a new session, s; then base::Error
  int page_width_px = 0, page_height_px = 0;  ///< 0: no page
  std::optional<double> refresh_hz{};         ///< refresh rate to request, one that the runtime lists
  /// If the runtime's times do not convert to the session's clock, the program guesses the offset between the
  /// clocks such that the first converted time is the current time, but not before earliest_ns.
  std::int64_t earliest_ns = 0;
};

/// One frame of the headset's runtime: a display period that can show one picture. HeadsetLayers is its
/// content.
struct HeadsetSlot {
  std::int64_t index = 0;         ///< from 0
  std::int64_t predicted_ns = 0;  ///< predicted display time on the session's clock; -1: invalid time
  std::int64_t period_ns = 0;     ///< period that the runtime reports; often wrong at first
  bool should_render = false;     ///< false: a picture would not be visible
  std::int64_t runtime_time = 0;  ///< predicted_ns on the runtime's clock
};

/// Position and size (m) of a page in the world. The pose is that of the page's centre; the page faces +z of
/// the pose.
struct HeadsetPage {
  HeadsetPose pose;
  float width_m = 0, height_m = 0;
};

/// The content of a slot.
struct HeadsetLayers {
  /// Pictures of both eyes side by side, left eye first, of picture_size(), with sRGB values as on a desktop.
  /// Null: black.
  const sim::Offscreen* picture = nullptr;
  EyeViews views{};                      ///< eye views for which the picture was drawn
  bool in_head = false;                  ///< views are in the head's frame: the picture moves with the head
  float light = 1;                       ///< factor on the picture's levels, [0, 1]
  const sim::Offscreen* page = nullptr;  ///< in front of the picture; null: no page
  HeadsetPage place{};                   ///< position of the page
  /// Version numbers of the picture and the page. While a number stays the same, the picture (or page) is not
  /// copied to the runtime again. 0: it is copied in every slot.
  std::uint64_t picture_number = 0, page_number = 0;
};

/// Names and properties that the runtime and the headset report.
struct HeadsetNames {
  std::string runtime, runtime_version, headset;
  std::string format;              ///< pixel format of the submitted pictures
  std::string blend;               ///< environment blend mode of the session
  bool position_tracking = false;  ///< the head's position is tracked, not only its direction
};

/// The refresh rate of the display, Hz, from two sources.
struct HeadsetRate {
  std::optional<double> reported_hz;  ///< by the runtime; only if it lists several rates
  std::optional<double> measured_hz;  ///< by RateMeter; none: not settled
};

/// One session of an OpenXR runtime, from connecting to disconnecting. Calls come from the thread on which
/// `gl` is current, except views_at() and views_in_head(). Another thread may take over between two calls,
/// together with the context. Calls throw base::Error if an OpenXR call fails, and HeadsetLost (loader.hpp)
/// once the session or the runtime is gone.
///
/// Run frames while running() is true. For each frame call wait(), begin(), then views(), input() and
/// drawing, then end(). Call poll() between frames.
class HeadsetSession {
 public:
  /// Connects. base::Error if the loader, the runtime or the headset is missing, or if the headset cannot
  /// hide the real world.
  explicit HeadsetSession(const sim::GlContext& gl, const HeadsetChoice& choice = {});
  ~HeadsetSession();
  HeadsetSession(const HeadsetSession&) = delete;
  HeadsetSession& operator=(const HeadsetSession&) = delete;

  std::string description() const;  ///< headset, picture size and pixel format
  /// true: the pixel format shows each of the 256 sRGB levels with an error of at most one level
  bool keeps_levels() const;
  bool times_convert() const;  ///< false: predicted_ns uses a guessed clock offset
  bool has_eye_gaze() const;
  HeadsetNames names() const;

  HeadsetState state() const;
  bool running() const;  ///< true: run frames
  std::vector<HeadsetEvent> poll();
  void request_exit();

  /// Sleeps until the next slot (frame) may begin. base::Error after HeadsetChoice::patience_s.
  HeadsetSlot wait();
  void begin(const HeadsetSlot& slot);
  /// Predicted eye views at the slot's display time. Draw only if can_be_shown() is true for them.
  EyeViews views(const HeadsetSlot& slot) { return views_at(slot.runtime_time); }
  /// Predicted eye views at a time of the runtime's clock. Any thread may call it.
  EyeViews views_at(std::int64_t runtime_time);
  /// As views_at(), but poses are in the head's frame. Any thread may call it.
  EyeViews views_in_head(std::int64_t runtime_time);
  HeadsetInput input(const HeadsetSlot& slot);
  /// Size of one eye's picture; eye: 0 left, 1 right.
  base::PictureSize eye_size(std::size_t eye) const;
  /// Size of both eyes' pictures side by side.
  base::PictureSize picture_size() const;
  /// Shows the layers; nothing if the slot should not render. Omits a picture whose eye views are not valid.
  void end(const HeadsetSlot& slot, const HeadsetLayers& layers = {});

  HeadsetRate rate() const;
  const RateMeter& meter() const;
  /// Requests one of the refresh rates that the runtime lists; base::Error for another rate. If the display
  /// changes its rate, rate() and an event report the new rate.
  void request_rate(double hz);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace study
