/// The session's states and the event queue.

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

/// Advances the virtual clock by a period if no session runs. A program whose headset is off calls only
/// xrPollEvent, so time would stand still otherwise.
void wait_a_period() {
  Runtime& all = runtime();
  const bool running = !all.sessions.empty() && all.sessions.begin()->second.running;
  if (running) return;
  if (!all.clock.real) all.clock.now += period();
  offer_ready();
}

XrResult poll_event(XrInstance instance, XrEventDataBuffer* out) {
  need_instance(instance);
  need_type(out, XR_TYPE_EVENT_DATA_BUFFER);
  auto& events = runtime().events;
  if (events.empty()) wait_a_period();
  if (events.empty()) return XR_EVENT_UNAVAILABLE;
  *out = events.front();
  events.pop_front();
  return XR_SUCCESS;
}

}  // namespace

const char* name_of(XrSessionState state) {
  static const char* const names[] = {"UNKNOWN", "IDLE",     "READY",        "SYNCHRONIZED", "VISIBLE",
                                      "FOCUSED", "STOPPING", "LOSS_PENDING", "EXITING"};
  return names[state];
}

void enter(XrSession session, XrSessionState state) {
  runtime().sessions.at(number_of(session)).state = state;
  log_line(std::string("state ") + name_of(state));
  XrEventDataSessionStateChanged event{};
  event.session = session;
  event.state = state;
  event.time = now();
  queue_event(event, XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED);
}

void step_state(XrSession session) {
  const Session& found = runtime().sessions.at(number_of(session));
  const XrSessionState aim = runtime().aim;
  if (!found.running || found.state > XR_SESSION_STATE_FOCUSED) return;
  if (aim == XR_SESSION_STATE_STOPPING) {
    for (int state = found.state - 1; state >= XR_SESSION_STATE_SYNCHRONIZED; --state)
      enter(session, static_cast<XrSessionState>(state));
    enter(session, aim);
    return;
  }
  if (found.state < aim && found.frames > 0) {
    enter(session, static_cast<XrSessionState>(found.state + 1));
    return;
  }
  for (int state = found.state - 1; state >= aim; --state) enter(session, static_cast<XrSessionState>(state));
}

void offer_ready() {
  Runtime& all = runtime();
  if (now() < all.worn_from) return;
  for (const auto& [number, session] : all.sessions) {
    if (session.running || session.exiting || session.state != XR_SESSION_STATE_IDLE) continue;
    all.aim = XR_SESSION_STATE_FOCUSED;
    enter(as_handle<XrSession>(number), XR_SESSION_STATE_READY);
  }
}

void add_event_functions(Functions& functions) {
  add<"xrPollEvent", poll_event, Logged::frame_line>(functions);
}

}  // namespace simulated
