/// The frame loop: waits for a slot of the display, begins and ends a frame.

#include <thread>
#include <utility>

#include "tests/headset/gl.hpp"
#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

Session& need_running(XrSession session) {
  Session& found = need_session(session);
  need(found.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  return found;
}

/// Waits until xrBeginFrame was called for the previous frame, or the session ended. Refuses after `patience`
/// s on the real clock.
void await_begin(XrSession session) {
  const auto over = [&] {
    const auto found = runtime().sessions.find(number_of(session));
    return found == runtime().sessions.end() || !found->second.running || !found->second.waited;
  };
  const std::chrono::duration<double> patience(runtime().knobs.at("patience"));
  need(frame_begun().wait_for(lock(), patience, over), XR_ERROR_CALL_ORDER_INVALID,
       "the frame before was never begun");
}

/// Time of the next refresh of the display that is at least half a period away. The script's event `drop`
/// skips refreshes once, the knob `skips` each time.
XrTime next_slot() {
  Runtime& all = runtime();
  const XrDuration step = period(), lead = 3 * step / 2;
  XrTime slot = all.clock.last_slot + step * (1 + all.dropped + static_cast<int>(all.knobs.at("skips")));
  all.dropped = 0;
  if (all.clock.last_slot == 0) slot = now() + lead;
  while (slot + step < now() + lead) slot += step;
  all.clock.last_slot = slot;
  return slot;
}

/// Pseudo-random number in [-1, 1) for a frame's number; the same in every run.
double noise(long index) {
  const auto mixed = static_cast<std::uint32_t>(index) * 2654435761u;
  return (mixed >> 8) / 8388608.0 - 1;
}

Frame next_frame(long index) {
  Runtime& all = runtime();
  const XrTime slot = next_slot();
  Frame out{index, slot + static_cast<XrDuration>(1e6 * all.knobs.at("jitter") * noise(index)), false};
  if (all.repeats) out.predicted = all.clock.last_predicted;
  all.repeats = false;
  all.clock.last_predicted = out.predicted;
  wait_until(slot - 3 * period() / 2);
  return out;
}

void hang(double seconds) {
  lock().unlock();
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  lock().lock();
}

XrResult wait_frame(XrSession session, const XrFrameWaitInfo* info, XrFrameState* state) {
  need_running(session);
  need_type_or_null(info, XR_TYPE_FRAME_WAIT_INFO);
  need_type(state, XR_TYPE_FRAME_STATE);
  await_begin(session);
  Runtime& all = runtime();
  const long index = all.frames++;
  play_script(session, index);
  const bool held_up = all.dropped > 0 || all.hang_seconds > 0 || all.knobs.at("skips") > 0;
  if (const double seconds = std::exchange(all.hang_seconds, 0); seconds > 0) hang(seconds);
  need_running(session);
  Frame frame = next_frame(index);
  Session& found = need_running(session);  // again, because the session may have ended during the wait
  if (held_up) all.clock.last_end = now();
  step_state(session);
  const bool seen = found.state == XR_SESSION_STATE_VISIBLE || found.state == XR_SESSION_STATE_FOCUSED;
  frame.should_render = seen && all.knobs.at("render") != 0;
  found.waiting = frame;
  found.waited = true;
  state->predictedDisplayTime = all.untimed > 0 ? -frame.predicted : frame.predicted;
  if (all.untimed > 0) --all.untimed;
  state->predictedDisplayPeriod =
      period() * (static_cast<double>(found.frames) < all.knobs.at("wrong_periods") ? 3 : 1);
  state->shouldRender = frame.should_render;
  return success(found);
}

XrResult begin_frame(XrSession session, const XrFrameBeginInfo* info) {
  Session& found = need_running(session);
  const SessionContext taken(found.graphics);
  need_type_or_null(info, XR_TYPE_FRAME_BEGIN_INFO);
  need(found.waited, XR_ERROR_CALL_ORDER_INVALID, "no frame was waited for");
  const bool discarded = found.begun;
  if (discarded) note("frame " + std::to_string(found.drawing.index) + " was never ended");
  found.drawing = found.waiting;
  found.waited = false;
  found.begun = true;
  frame_begun().notify_all();
  return discarded ? XR_FRAME_DISCARDED : success(found);
}

void check_end(const Session& session, const XrFrameEndInfo* info) {
  need(session.begun, XR_ERROR_CALL_ORDER_INVALID, "no frame was begun");
  need_type(info, XR_TYPE_FRAME_END_INFO);
  need_chain(info->next);
  need(info->displayTime > 0, XR_ERROR_TIME_INVALID, "a displayTime that is not positive");
  const bool opaque = info->environmentBlendMode == XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
  const bool additive = info->environmentBlendMode == XR_ENVIRONMENT_BLEND_MODE_ADDITIVE;
  need(additive || (opaque && runtime().profile.opaque), XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED,
       "a blend mode that is not listed");
  if (info->displayTime != session.drawing.predicted)
    note("a displayTime that was not predicted for this frame (allowed)");
  if (info->layerCount > 0 && !session.drawing.should_render)
    note("layers although shouldRender was false (allowed)");
}

/// Logs a note if more than two periods have passed since the previous xrEndFrame. A delay by the script's
/// events `drop` and `hang` does not count.
void note_starving() {
  Clock& clock = runtime().clock;
  const XrTime time = now();
  const auto tenths = (time - clock.last_end) * 10 / period();
  if (clock.last_end > 0 && time - clock.last_end > 2 * period())
    note("starved for " + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " periods");
  clock.last_end = time;
}

XrResult end_frame(XrSession session, const XrFrameEndInfo* info) {
  Session& found = need_running(session);
  const SessionContext taken(found.graphics);
  check_end(found, info);
  std::string layers;
  const std::vector<Shown> images = check_layers(found, *info, layers);
  layers += look_at(images, found.drawing.index);
  note_starving();
  const Frame& frame = found.drawing;
  log_line("frame " + std::to_string(frame.index) + " predicted " + std::to_string(frame.predicted) +
           " display " + std::to_string(info->displayTime) + " now " + std::to_string(now()) + " state " +
           name_of(found.state) + " render " + std::to_string(frame.should_render) + " layers " +
           std::to_string(info->layerCount) + layers);
  found.begun = false;
  found.frames += 1;
  step_state(session);
  return success(found);
}

}  // namespace

void add_frame_functions(Functions& functions) {
  add<"xrWaitFrame", wait_frame, Logged::frame_line>(functions);
  add<"xrBeginFrame", begin_frame, Logged::frame_line>(functions);
  add<"xrEndFrame", end_frame, Logged::frame_line>(functions);
}

}  // namespace simulated
