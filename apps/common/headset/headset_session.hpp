#pragma once
/// A session in a headset, frame by frame.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/headset/events.hpp"
#include "apps/common/headset/input.hpp"
#include "apps/common/headset/rate_meter.hpp"
#include "apps/common/headset/views.hpp"
#include "apps/common/picture_size.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"

namespace apps {

struct HeadsetChoice {
  bool eye_gaze = false;                      ///< asks for eye tracking; only with the participant's consent
  double patience_s = 10;                     ///< a wait of the runtime that lasts longer ends the session
  int page_width_px = 0, page_height_px = 0;  ///< 0: no page
  std::optional<double> refresh_hz{};         ///< asked for; see request_rate()
  /// Where the runtime's times do not convert: their clock does not begin before it.
  std::int64_t earliest_ns = 0;
};

/// A picture's turn on the display.
struct HeadsetSlot {
  std::int64_t index = 0;         ///< from 0
  std::int64_t predicted_ns = 0;  ///< when it is to be seen, on the session's clock
  std::int64_t period_ns = 0;     ///< as the runtime tells it; often wrong at first
  bool should_render = false;     ///< false: nothing of it would be seen
  std::int64_t runtime_time = 0;  ///< predicted_ns as the runtime counts
};

/// A page that stands in the world: its middle and turn, m. It faces along +z of its pose.
struct HeadsetPage {
  HeadsetPose pose;
  float width_m = 0, height_m = 0;
};

/// What a slot shows.
struct HeadsetLayers {
  /// Of picture_size(), both eyes beside each other, the left one first: values as on a desktop, sRGB. None:
  /// black.
  const sim::Offscreen* picture = nullptr;
  EyeViews views{};                      ///< what it was drawn from
  bool in_head = false;                  ///< the views are in the head's space: it moves with the head
  float light = 1;                       ///< by which its levels are multiplied, [0, 1]
  const sim::Offscreen* page = nullptr;  ///< of the size that was chosen; before the picture. None: no page
  HeadsetPage place{};                   ///< of the page
};

/// What runtime and headset call themselves and tell.
struct HeadsetNames {
  std::string runtime, runtime_version, headset;
  std::string format;              ///< of the pictures handed over
  std::string blend;               ///< environment blend mode that was chosen of those offered
  bool position_tracking = false;  ///< the head's place is followed, not its direction alone
};

/// A display rate and where it is from.
struct HeadsetRate {
  std::optional<double> told_hz;      ///< by the runtime; only where it lists several rates
  std::optional<double> measured_hz;  ///< settled steps between predicted times
};

/// One session of one runtime, from connecting to leaving. All calls but views_at() come from the thread on
/// which `gl` is current; another one may take over between two calls, with the context. base::Error for
/// what is not there and for calls that fail; HeadsetLost (loader.hpp) once session or runtime are gone.
///
/// A frame is wait, begin, then views, input and drawing, then end, while running(); poll() between frames.
class HeadsetSession {
 public:
  /// Connects. Headsets that show the world through the picture are refused.
  explicit HeadsetSession(const sim::GlContext& gl, const HeadsetChoice& choice = {});
  ~HeadsetSession();
  HeadsetSession(const HeadsetSession&) = delete;
  HeadsetSession& operator=(const HeadsetSession&) = delete;

  std::string description() const;  ///< headset, picture and format
  bool keeps_levels() const;        ///< 0 to 255 arrive within one level
  bool times_convert() const;       ///< else predicted_ns is a guess of where the runtime's clock stands
  bool has_eye_gaze() const;
  HeadsetNames names() const;

  HeadsetState state() const;
  bool running() const;  ///< frames must come
  std::vector<HeadsetEvent> poll();
  void request_exit();

  /// Sleeps until the next picture's turn.
  HeadsetSlot wait();
  void begin(const HeadsetSlot& slot);
  /// Where the eyes will be. Draw only when can_be_shown().
  EyeViews views(const HeadsetSlot& slot) { return views_at(slot.runtime_time); }
  /// The same at any time of the runtime's; from any thread.
  EyeViews views_at(std::int64_t runtime_time);
  /// The same in the head's own space.
  EyeViews views_in_head(std::int64_t runtime_time);
  HeadsetInput input(const HeadsetSlot& slot);
  /// Of an eye, 0 left, 1 right.
  PictureSize eye_size(std::size_t eye) const;
  /// Of both beside each other.
  PictureSize picture_size() const;
  /// Shows the layers; nothing where the slot should not render.
  void end(const HeadsetSlot& slot, const HeadsetLayers& layers = {});

  HeadsetRate rate() const;
  const RateMeter& meter() const;
  /// Asks for a listed rate; rate() and an event tell whether it came.
  void request_rate(double hz);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace apps
