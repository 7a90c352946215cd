#include "libstudy/headset/headset_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libstudy/headset/actions.hpp"
#include "libstudy/headset/lifecycle.hpp"
#include "libstudy/headset/refresh.hpp"
#include "libstudy/headset/swapchain.hpp"
#include "libstudy/headset/watched_thread.hpp"

namespace study {

namespace {

constexpr XrEnvironmentBlendMode blend_mode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
constexpr const char* blend_name = "opaque";
/// Relative difference up to which a reported rate counts as the one that was asked for.
constexpr double rate_tolerance = 0.005;
/// Largest number of successive slots without a valid predicted time before the session ends with an error.
constexpr int most_untimed = 30;

HeadsetSystem read_opaque_system(const XrConnection& xr) {
  HeadsetSystem system = read_system(xr);
  if (system.opaque) return system;
  throw base::Error("headset", system.name + " shows the world through the picture",
                    "use a headset that hides the world");
}

std::vector<base::PictureSize> picture_sizes(const HeadsetSystem& system, const HeadsetChoice& choice) {
  std::vector<base::PictureSize> sizes;
  for (const auto& view : system.views)
    sizes.push_back({static_cast<int>(view.recommendedImageRectWidth),
                     static_cast<int>(view.recommendedImageRectHeight)});
  if (choice.page_width_px > 0) sizes.push_back({choice.page_width_px, choice.page_height_px});
  return sizes;
}

}  // namespace

const char* name_of(HeadsetState state) {
  constexpr const char* names[] = {"unknown", "idle",     "ready",        "synchronized", "visible",
                                   "focused", "stopping", "loss pending", "exiting"};
  return names[static_cast<std::size_t>(state)];
}

/// The parts of a session, in the order of their construction: each may use those above it.
struct HeadsetSession::Parts {
  Parts(const sim::GlContext& gl, const HeadsetChoice& choice)
      : patience(static_cast<std::int64_t>(choice.patience_s * 1e9)),
        xr(connect_to_headset(choice.eye_gaze, choice.user_presence)),
        system(read_opaque_system(xr)),
        session(xr, system.id, gl),
        clock(xr, choice.earliest_ns),
        lifecycle(session, clock),
        refresh(session),
        world(session, XR_REFERENCE_SPACE_TYPE_LOCAL),
        head(session, XR_REFERENCE_SPACE_TYPE_VIEW),
        actions(session, clock, system.eye_gaze) {
    sizes = picture_sizes(system, choice);
    swapchains = make_swapchains(session, sizes);
    if (choice.refresh_hz) refresh.request(*choice.refresh_hz);
    held_hz = choice.refresh_hz;
    if (const auto hz = refresh.reported_hz()) take_rate(*hz);
  }

  std::chrono::nanoseconds patience;
  XrConnection xr;
  HeadsetSystem system;
  SessionHandle session;
  RuntimeClock clock;
  Lifecycle lifecycle;
  RefreshControl refresh;
  Space world, head;
  Actions actions;
  std::vector<base::PictureSize> sizes;                ///< of left eye, right eye and, if requested, page
  std::vector<std::unique_ptr<Swapchain>> swapchains;  ///< in the order of `sizes`
  RateMeter meter;
  double reported_hz = 0;         ///< rate that the runtime reported last; 0: none
  std::optional<double> held_hz;  ///< rate that the program asked for; it asks again while it is not in force
  std::int64_t asked_ns = 0;      ///< when it asked last
  std::optional<HeadsetEvent> measured;  ///< a change of the rate that no event reported
  std::int64_t next_index = 0;
  XrTime last_time = 0;          ///< predicted time of the last slot; 0: no slot yet
  std::int64_t last_period = 0;  ///< period of the last slot, ns
  int untimed = 0;               ///< slots in a row without a valid predicted time
  WatchedThread watched;

  XrFrameState wait_frame();
  XrTime time_for_untimed();
  void take_rate(double hz);
  void follow_rate(std::int64_t predicted_ns);
  void hold_rate(std::int64_t predicted_ns);
  EyeViews locate(std::int64_t runtime_time, const Space& space) const;
  XrCompositionLayerProjectionView layer_view(const HeadsetEye& eye, const Swapchain& swapchain) const;
};

XrFrameState HeadsetSession::Parts::wait_frame() {
  struct Answer {
    XrResult result = XR_SUCCESS;
    XrFrameState frame{};
  };
  const auto answer = std::make_shared<Answer>();
  answer->frame.type = XR_TYPE_FRAME_STATE;
  const auto call = xr.function<PFN_xrWaitFrame>("xrWaitFrame");
  // xrWaitFrame may never return, so another thread calls it. The call needs no OpenGL context.
  const bool back = watched.run(
      [answer, call, handle = session.get()] {
        XrFrameWaitInfo info{};
        info.type = XR_TYPE_FRAME_WAIT_INFO;
        answer->result = call(handle, &info, &answer->frame);
      },
      patience);
  if (!back) {
    session.leave_behind();
    xr.leave_behind();
    throw DisplayGone(CutCause::Hang, "headset",
                      fmt::format("the runtime has let no frame begin for {:g} s",
                                  std::chrono::duration<double>(patience).count()),
                      "restart the headset's software; vip-study resume continues a session");
  }
  check_xr(answer->result, "xrWaitFrame");
  return answer->frame;
}

/// A time for a slot for which the runtime predicted none: a period after the last slot. base::Error if there
/// was no slot before, or after most_untimed of these in a row.
XrTime HeadsetSession::Parts::time_for_untimed() {
  if (last_time > 0 && last_period > 0 && ++untimed <= most_untimed) return last_time + last_period;
  throw DisplayGone(CutCause::Hang, "headset", "the runtime predicts no valid times for its frames",
                    "restart the headset's software; vip-study resume continues a session");
}

void HeadsetSession::Parts::take_rate(double hz) {
  reported_hz = hz;
  meter.report(hz);
}

/// Measures the rate. A change that the runtime tells by no event becomes an event: the rate that it reports
/// is another one than before or, where it reports none that fits, the measured rate is.
void HeadsetSession::Parts::follow_rate(std::int64_t predicted_ns) {
  std::optional<RateChange> change = meter.add(predicted_ns);
  if (meter.contradicted()) {
    const double before_hz = reported_hz, now_hz = refresh.reported_hz().value_or(before_hz);
    if (now_hz == before_hz) {
      meter.doubt();
    } else {
      take_rate(now_hz);
      change = RateChange{before_hz, now_hz};
    }
  }
  if (!change) return;
  measured = {.kind = HeadsetEvent::Kind::Refresh,
              .from_hz = change->from_hz,
              .to_hz = change->to_hz,
              .at_ns = predicted_ns};
}

/// Asks for the held rate once a second while the runtime reports another one.
void HeadsetSession::Parts::hold_rate(std::int64_t predicted_ns) {
  constexpr std::int64_t ask_again_ns = 1'000'000'000;
  const bool held = !held_hz || std::abs(reported_hz - *held_hz) <= rate_tolerance * *held_hz;
  if (held || predicted_ns - asked_ns < ask_again_ns) return;
  asked_ns = predicted_ns;
  refresh.request_again(*held_hz);
}

XrCompositionLayerProjectionView HeadsetSession::Parts::layer_view(const HeadsetEye& eye,
                                                                   const Swapchain& swapchain) const {
  XrCompositionLayerProjectionView view{};
  view.type = XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW;
  view.pose = pose_of(eye.pose);
  view.fov = {eye.fov.left, eye.fov.right, eye.fov.up, eye.fov.down};
  view.subImage = swapchain.image();
  return view;
}

EyeViews HeadsetSession::Parts::locate(std::int64_t runtime_time, const Space& space) const {
  XrViewLocateInfo info{};
  info.type = XR_TYPE_VIEW_LOCATE_INFO;
  info.viewConfigurationType = stereo_views;
  info.displayTime = runtime_time;
  info.space = space.get();
  XrViewState state{};
  state.type = XR_TYPE_VIEW_STATE;
  std::array<XrView, 2> found{};
  for (XrView& view : found) view.type = XR_TYPE_VIEW;
  std::uint32_t count = 0;
  session.call<PFN_xrLocateViews>("xrLocateViews", session.get(), &info, &state, 2u, &count, found.data());
  EyeViews out;
  for (std::size_t eye = 0; eye < out.size(); ++eye) {
    const XrFovf& fov = found[eye].fov;
    out[eye] = {pose_of(found[eye].pose, state.viewStateFlags),
                {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown},
                sizes[eye].width,
                sizes[eye].height};
  }
  return out;
}

HeadsetSession::HeadsetSession(const sim::GlContext& gl, const HeadsetChoice& choice)
    : parts_(std::make_unique<Parts>(gl, choice)) {}
HeadsetSession::~HeadsetSession() = default;

std::string HeadsetSession::description() const {
  return fmt::format("{}, {} x {} px an eye, {}", parts_->system.name, eye_size(0).width, eye_size(0).height,
                     gl_format_name(parts_->swapchains[0]->format()));
}

bool HeadsetSession::keeps_levels() const { return study::keeps_levels(parts_->swapchains[0]->format()); }
bool HeadsetSession::times_convert() const { return parts_->clock.converts(); }
bool HeadsetSession::has_eye_gaze() const { return parts_->system.eye_gaze; }
HeadsetNames HeadsetSession::names() const {
  const auto [runtime, version] = read_runtime(parts_->xr);
  return {runtime,
          version,
          parts_->system.name,
          gl_format_name(parts_->swapchains[0]->format()),
          blend_name,
          parts_->system.position};
}
HeadsetState HeadsetSession::state() const { return parts_->lifecycle.state(); }
bool HeadsetSession::running() const { return parts_->lifecycle.running(); }
void HeadsetSession::request_exit() { parts_->lifecycle.request_exit(); }

std::vector<HeadsetEvent> HeadsetSession::poll() {
  std::vector<HeadsetEvent> events = parts_->lifecycle.poll();
  for (const HeadsetEvent& event : events) {
    if (event.kind == HeadsetEvent::Kind::Refresh) parts_->take_rate(event.to_hz);
    if (event.state == HeadsetState::Stopping) parts_->meter.interrupt();
  }
  if (parts_->measured) events.push_back(*parts_->measured);
  parts_->measured.reset();
  return events;
}

HeadsetSlot HeadsetSession::wait() {
  Parts& parts = *parts_;
  XrFrameState frame = parts.wait_frame();
  const bool timed = frame.predictedDisplayTime > 0;
  if (timed) parts.untimed = 0;
  if (!timed) frame.predictedDisplayTime = parts.time_for_untimed();
  HeadsetSlot slot{parts.next_index++, parts.clock.to_ns(frame.predictedDisplayTime),
                   frame.predictedDisplayPeriod, frame.shouldRender == XR_TRUE, frame.predictedDisplayTime};
  parts.last_time = slot.runtime_time;
  parts.last_period = slot.period_ns;
  if (!timed) return slot;  // the meter counts it as a slot that was left out
  parts.follow_rate(slot.predicted_ns);
  parts.hold_rate(slot.predicted_ns);
  return slot;
}

void HeadsetSession::begin(const HeadsetSlot&) {
  XrFrameBeginInfo info{};
  info.type = XR_TYPE_FRAME_BEGIN_INFO;
  parts_->session.call<PFN_xrBeginFrame>("xrBeginFrame", parts_->session.get(), &info);
}

EyeViews HeadsetSession::views_at(std::int64_t runtime_time) {
  return parts_->locate(runtime_time, parts_->world);
}

EyeViews HeadsetSession::views_in_head(std::int64_t runtime_time) {
  return parts_->locate(runtime_time, parts_->head);
}

HeadsetInput HeadsetSession::input(const HeadsetSlot& slot) {
  HeadsetInput out;
  out.head = parts_->head.locate(parts_->world, slot.runtime_time);
  if (state() == HeadsetState::Focused) parts_->actions.read(parts_->world, slot.runtime_time, out);
  return out;
}

base::PictureSize HeadsetSession::eye_size(std::size_t eye) const { return parts_->sizes.at(eye); }

base::PictureSize HeadsetSession::picture_size() const {
  const base::PictureSize left = eye_size(0), right = eye_size(1);
  return {left.width + right.width, std::max(left.height, right.height)};
}

void HeadsetSession::end(const HeadsetSlot& slot, const HeadsetLayers& shown) {
  Parts& parts = *parts_;
  std::vector<const XrCompositionLayerBaseHeader*> layers;
  std::array<XrCompositionLayerProjectionView, 2> views{};
  XrCompositionLayerProjection projection{};
  XrCompositionLayerQuad quad{};
  if (slot.should_render && shown.picture && can_be_shown(shown.views)) {
    for (std::size_t eye = 0; eye < views.size(); ++eye) {
      const PicturePart part{eye == 0 ? 0 : parts.sizes[0].width, shown.light};
      parts.swapchains[eye]->write(*shown.picture, part, shown.picture_number, parts.patience);
      views[eye] = parts.layer_view(shown.views[eye], *parts.swapchains[eye]);
    }
    projection.type = XR_TYPE_COMPOSITION_LAYER_PROJECTION;
    projection.space = (shown.in_head ? parts.head : parts.world).get();
    projection.viewCount = static_cast<std::uint32_t>(views.size());
    projection.views = views.data();
    layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection));
  }
  if (slot.should_render && shown.page) {
    Swapchain& swapchain = *parts.swapchains.at(2);
    swapchain.write(*shown.page, {}, shown.page_number, parts.patience);
    quad.type = XR_TYPE_COMPOSITION_LAYER_QUAD;
    quad.space = parts.world.get();
    quad.eyeVisibility = XR_EYE_VISIBILITY_BOTH;
    quad.subImage = swapchain.image();
    quad.pose = pose_of(shown.place.pose);
    quad.size = {shown.place.width_m, shown.place.height_m};
    layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&quad));
  }
  XrFrameEndInfo info{};
  info.type = XR_TYPE_FRAME_END_INFO;
  info.displayTime = slot.runtime_time;
  info.environmentBlendMode = blend_mode;
  info.layerCount = static_cast<std::uint32_t>(layers.size());
  info.layers = layers.data();
  parts.session.call<PFN_xrEndFrame>("xrEndFrame", parts.session.get(), &info);
}

HeadsetRate HeadsetSession::rate() const { return {parts_->refresh.reported_hz(), parts_->meter.hz()}; }
const RateMeter& HeadsetSession::meter() const { return parts_->meter; }
void HeadsetSession::request_rate(double hz) { parts_->refresh.request(hz); }

}  // namespace study
