#pragma once
/// A session in a headset, frame by frame.

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

/// As in OpenXR's specification.
enum class HeadsetState {
  Unknown,
  Idle,
  Ready,         ///< frames begin
  Synchronized,  ///< frames run, but nothing is seen
  Visible,       ///< pictures are seen, but there is no input from controllers and eyes
  Focused,
  Stopping,     ///< frames end: the headset was taken off, or the session is about to end
  LossPending,  ///< the session must be made again
  Exiting,      ///< the session must end, and no new one may start by itself
};

/// "focused".
const char* name_of(HeadsetState state);

struct HeadsetEvent {
  enum class Kind {
    State,        ///< `state` was entered
    RuntimeEnds,  ///< the whole runtime shuts down at `at_ns`
    Refresh,      ///< the display changed its rate, Hz
    Recentred,    ///< the world's origin moves at `at_ns`
    EventsLost,   ///< some events were dropped
    Lost,         ///< the session is gone; no slots come until MadeAnew
    MadeAnew,     ///< a new session replaces a lost one
  };
  Kind kind = Kind::State;
  HeadsetState state = HeadsetState::Unknown;
  double from_hz = 0, to_hz = 0;
  std::int64_t at_ns = -1;  ///< the session's clock; -1: not reported
};

/// One ray for both eyes; it starts at `ray.place_m` and goes along direction_of(ray).
struct HeadsetGaze {
  /// When the eyes were sampled, on the session's clock; none if the runtime does not say.
  std::optional<std::int64_t> sampled_ns;
  HeadsetPose ray;  ///< orientation valid but not tracked: sub-nominal
};

/// Buttons and pointing. A button held on both hands counts once.
struct HeadsetHands {
  bool select = false;                            ///< pressed now
  bool select_began = false;                      ///< pressed since the last reading
  bool menu = false;                              ///< pressed now
  std::array<float, 2> stick{};                   ///< right and up, [-1, 1]; 0 without a stick
  std::array<std::optional<HeadsetPose>, 2> aim;  ///< left and right hand; along direction_of()
};

/// The participant's input: gaze, head pose, buttons and pointing.
struct HeadsetInput {
  HeadsetPose head;
  bool focused = false;             ///< the following members are set only while focused
  std::optional<HeadsetGaze> gaze;  ///< none: no tracker, or no data now
  HeadsetHands hands;
};

struct HeadsetChoice {
  bool eye_gaze = false;                      ///< asks for eye tracking; only with the participant's consent
  double patience_s = 10;                     ///< longest wait for the runtime; a longer one ends the session
  int page_width_px = 0, page_height_px = 0;  ///< 0: no page
  std::optional<double> refresh_hz{};         ///< rate to ask for; see request_rate()
  /// If the runtime's times do not convert, their clock does not start before this time.
  std::int64_t earliest_ns = 0;
};

/// One frame of the headset's runtime, for one picture. The content is HeadsetLayers.
struct HeadsetSlot {
  std::int64_t index = 0;         ///< from 0
  std::int64_t predicted_ns = 0;  ///< when its picture is to be seen, on the session's clock
  std::int64_t period_ns = 0;     ///< as the runtime reports it; often wrong at first
  bool should_render = false;     ///< false: its picture would not be seen
  std::int64_t runtime_time = 0;  ///< predicted_ns on the runtime's clock
};

/// Place of a page in the world: its centre, orientation and size, m. It faces along +z of its pose.
struct HeadsetPage {
  HeadsetPose pose;
  float width_m = 0, height_m = 0;
};

/// The content of a slot.
struct HeadsetLayers {
  /// Of picture_size(), both eyes side by side, the left one first; sRGB values, as on a desktop. Null:
  /// black.
  const sim::Offscreen* picture = nullptr;
  EyeViews views{};      ///< that the picture was drawn from
  bool in_head = false;  ///< the views are in the head's space: the picture moves with the head
  float light = 1;       ///< factor of the picture's levels, [0, 1]
  const sim::Offscreen* page = nullptr;  ///< of the chosen size; in front of the picture. Null: no page
  HeadsetPage place{};                   ///< of the page
  /// Content that keeps its number is copied to the runtime once, however many slots show it; 0: in each
  /// slot.
  std::uint64_t picture_number = 0, page_number = 0;
};

/// Names and properties that runtime and headset report.
struct HeadsetNames {
  std::string runtime, runtime_version, headset;
  std::string format;              ///< of the pictures handed over
  std::string blend;               ///< environment blend mode chosen from those offered
  bool position_tracking = false;  ///< the head's position is tracked, not only its direction
};

/// A display rate and its source.
struct HeadsetRate {
  std::optional<double> reported_hz;  ///< reported by the runtime; only if it lists several rates
  std::optional<double> measured_hz;  ///< from settled steps between predicted times
};

/// One session of one runtime, from connecting to leaving. All calls except views_at() come from the thread
/// on which `gl` is current; another thread can take over between two calls, with the context. base::Error
/// for missing parts and failed calls; HeadsetLost (loader.hpp) once the session or the runtime is gone.
///
/// A frame is wait, begin, then views, input and drawing, then end, while running(); call poll() between
/// frames.
class HeadsetSession {
 public:
  /// Connects. Refuses headsets that show the real world through the picture.
  explicit HeadsetSession(const sim::GlContext& gl, const HeadsetChoice& choice = {});
  ~HeadsetSession();
  HeadsetSession(const HeadsetSession&) = delete;
  HeadsetSession& operator=(const HeadsetSession&) = delete;

  std::string description() const;  ///< headset, picture and format
  bool keeps_levels() const;        ///< levels 0 to 255 arrive within one level
  bool times_convert() const;       ///< otherwise predicted_ns rests on a guess of the runtime's clock
  bool has_eye_gaze() const;
  HeadsetNames names() const;

  HeadsetState state() const;
  bool running() const;  ///< frames must be run
  std::vector<HeadsetEvent> poll();
  void request_exit();

  /// Sleeps until the next slot.
  HeadsetSlot wait();
  void begin(const HeadsetSlot& slot);
  /// Where the eyes will be. Draw only if can_be_shown().
  EyeViews views(const HeadsetSlot& slot) { return views_at(slot.runtime_time); }
  /// The same at any time of the runtime; from any thread.
  EyeViews views_at(std::int64_t runtime_time);
  /// The same in the head's own space.
  EyeViews views_in_head(std::int64_t runtime_time);
  HeadsetInput input(const HeadsetSlot& slot);
  /// Picture size of an eye, 0 left, 1 right.
  base::PictureSize eye_size(std::size_t eye) const;
  /// Size of both eyes' pictures side by side.
  base::PictureSize picture_size() const;
  /// Shows the layers; nothing if the slot should not render.
  void end(const HeadsetSlot& slot, const HeadsetLayers& layers = {});

  HeadsetRate rate() const;
  const RateMeter& meter() const;
  /// Asks for a listed rate; rate() and an event tell if it came.
  void request_rate(double hz);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace study
