/// Runs the profile's events at their frames.

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

Session& session_of(XrSession session) { return runtime().sessions.at(number_of(session)); }

void recentre(XrSession session, double degrees) {
  XrEventDataReferenceSpaceChangePending event{};
  event.session = session;
  event.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
  event.changeTime = now() + static_cast<XrDuration>(1e9 * runtime().knobs.at("recentre_lead"));
  event.poseValid = XR_TRUE;
  event.poseInPreviousSpace = to_xr({turned(degrees, 0, 0), {}});
  runtime().local_turns.push_back({event.changeTime, degrees});
  queue_event(event, XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING);
}

void lose_instance(long frame, double frames) {
  XrEventDataInstanceLossPending event{};
  event.lossTime = now() + static_cast<XrDuration>(frames) * period();
  runtime().instance_lost_at = frame + static_cast<long>(frames);
  queue_event(event, XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING);
}

void lose_events(double events) {
  XrEventDataEventsLost event{};
  event.lostEventCount = static_cast<std::uint32_t>(events);
  queue_event(event, XR_TYPE_EVENT_DATA_EVENTS_LOST);
}

/// Reports that somebody wears the headset, or that nobody does, if the program asked for it.
void report_presence(XrSession session, bool worn) {
  if (!runtime().profile.presence || !runtime().enabled.contains(XR_EXT_USER_PRESENCE_EXTENSION_NAME)) return;
  XrEventDataUserPresenceChangedEXT event{};
  event.session = session;
  event.isUserPresent = worn;
  queue_event(event, XR_TYPE_EVENT_DATA_USER_PRESENCE_CHANGED_EXT);
}

void play(XrSession session, const ScriptedEvent& event) {
  Runtime& all = runtime();
  const auto& [frame, name, value] = event;
  log_line("script " + name + " " + std::to_string(value));
  if (all.knobs.contains(name)) all.knobs[name] = value;
  if (name == "focus") all.aim = value != 0 ? XR_SESSION_STATE_FOCUSED : XR_SESSION_STATE_VISIBLE;
  if (name == "shown") all.aim = value != 0 ? XR_SESSION_STATE_FOCUSED : XR_SESSION_STATE_SYNCHRONIZED;
  if (name == "off" || name == "exit") all.aim = XR_SESSION_STATE_STOPPING;
  if (name == "off") all.worn_from = now() + static_cast<XrDuration>(1e9 * value);
  if (name == "exit") session_of(session).exiting = true;
  if (name == "lost") enter(session, XR_SESSION_STATE_LOSS_PENDING);
  if (name == "lost") session_of(session).lost_at = frame + static_cast<long>(value);
  if (name == "lost_now") session_of(session).lost_at = frame;
  if (name == "instance_lost") lose_instance(frame, value);
  if (name == "unknown") queue_event(XrEventDataBaseHeader{}, static_cast<XrStructureType>(1'999'999'999));
  if (name == "events_lost") lose_events(value);
  if (name == "recentre") recentre(session, value);
  if (name == "rate") change_rate(static_cast<float>(value));
  if (name == "rate_untold") all.profile.rate = static_cast<float>(value);
  if (name == "drop") all.dropped = static_cast<int>(value);
  if (name == "repeat") all.repeats = true;
  if (name == "untimed") all.untimed = static_cast<int>(value);
  if (name == "worn") report_presence(session, value != 0);
  if (name == "hang") all.hang_seconds = value;
}

}  // namespace

void play_script(XrSession session, long frame) {
  take_wanted_rate();
  for (const ScriptedEvent& event : runtime().profile.script) {
    if (event.frame == frame) play(session, event);
  }
}

}  // namespace simulated
