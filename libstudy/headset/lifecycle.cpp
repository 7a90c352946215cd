#include "libstudy/headset/lifecycle.hpp"

namespace study {

namespace {

HeadsetState state_of(XrSessionState state) {
  switch (state) {
    case XR_SESSION_STATE_IDLE:
      return HeadsetState::Idle;
    case XR_SESSION_STATE_READY:
      return HeadsetState::Ready;
    case XR_SESSION_STATE_SYNCHRONIZED:
      return HeadsetState::Synchronized;
    case XR_SESSION_STATE_VISIBLE:
      return HeadsetState::Visible;
    case XR_SESSION_STATE_FOCUSED:
      return HeadsetState::Focused;
    case XR_SESSION_STATE_STOPPING:
      return HeadsetState::Stopping;
    case XR_SESSION_STATE_LOSS_PENDING:
      return HeadsetState::LossPending;
    case XR_SESSION_STATE_EXITING:
      return HeadsetState::Exiting;
    default:
      return HeadsetState::Unknown;
  }
}

template <class Event>
const Event& as(const XrEventDataBuffer& buffer) {
  return reinterpret_cast<const Event&>(buffer);
}

}  // namespace

Lifecycle::Lifecycle(const SessionHandle& session, RuntimeClock& clock) : session_(session), clock_(clock) {}

void Lifecycle::enter(XrSessionState state, std::vector<HeadsetEvent>& out) {
  state_ = state_of(state);
  if (state_ == HeadsetState::Ready) {
    XrSessionBeginInfo info{};
    info.type = XR_TYPE_SESSION_BEGIN_INFO;
    info.primaryViewConfigurationType = stereo_views;
    session_.call<PFN_xrBeginSession>("xrBeginSession", session_.get(), &info);
    running_ = true;
  }
  if (state_ == HeadsetState::Stopping) {
    running_ = false;
    session_.call<PFN_xrEndSession>("xrEndSession", session_.get());
  }
  // In these states the specification requires that the session is destroyed, so no more frames run.
  if (state_ == HeadsetState::LossPending || state_ == HeadsetState::Exiting) running_ = false;
  out.push_back({.kind = HeadsetEvent::Kind::State, .state = state_});
}

void Lifecycle::take(const XrEventDataBuffer& event, std::vector<HeadsetEvent>& out) {
  using Kind = HeadsetEvent::Kind;
  switch (static_cast<int>(event.type)) {
    case XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED: {
      const auto& changed = as<XrEventDataSessionStateChanged>(event);
      if (changed.session == session_.get()) enter(changed.state, out);
      break;
    }
    case XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING:
      out.push_back({.kind = Kind::RuntimeEnds,
                     .at_ns = clock_.to_ns(as<XrEventDataInstanceLossPending>(event).lossTime)});
      break;
    case XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING: {
      const auto& changed = as<XrEventDataReferenceSpaceChangePending>(event);
      if (changed.session == session_.get() && changed.referenceSpaceType == XR_REFERENCE_SPACE_TYPE_LOCAL)
        out.push_back({.kind = Kind::Recentred, .at_ns = clock_.to_ns(changed.changeTime)});
      break;
    }
    case XR_TYPE_EVENT_DATA_DISPLAY_REFRESH_RATE_CHANGED_FB: {
      const auto& changed = as<XrEventDataDisplayRefreshRateChangedFB>(event);
      out.push_back({.kind = Kind::Refresh,
                     .from_hz = static_cast<double>(changed.fromDisplayRefreshRate),
                     .to_hz = static_cast<double>(changed.toDisplayRefreshRate)});
      break;
    }
    case XR_TYPE_EVENT_DATA_USER_PRESENCE_CHANGED_EXT: {
      const auto& changed = as<XrEventDataUserPresenceChangedEXT>(event);
      if (changed.session == session_.get())
        out.push_back({.kind = Kind::Presence, .worn = changed.isUserPresent == XR_TRUE});
      break;
    }
    case XR_TYPE_EVENT_DATA_EVENTS_LOST:
      out.push_back({.kind = Kind::EventsLost});
      break;
    default:
      break;
  }
}

std::vector<HeadsetEvent> Lifecycle::poll() {
  std::vector<HeadsetEvent> out;
  while (true) {
    XrEventDataBuffer event{};
    event.type = XR_TYPE_EVENT_DATA_BUFFER;
    if (session_.call<PFN_xrPollEvent>("xrPollEvent", session_.xr().instance(), &event) != XR_SUCCESS)
      return out;  // XR_EVENT_UNAVAILABLE
    take(event, out);
  }
}

void Lifecycle::request_exit() const {
  if (running_) session_.call<PFN_xrRequestExitSession>("xrRequestExitSession", session_.get());
}

}  // namespace study
