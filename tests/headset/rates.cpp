/// The display's refresh rates.

#include <utility>

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

XrResult enumerate_rates(XrSession session, std::uint32_t capacity, std::uint32_t* count, float* out) {
  const Session& found = need_session(session);
  const XrResult result = give_values(runtime().profile.rates, capacity, count, out);
  return result == XR_SUCCESS ? success(found) : result;
}

XrResult get_rate(XrSession session, float* out) {
  const Session& found = need_session(session);
  *out = runtime().profile.rate;
  return success(found);
}

/// The rate changes at the next xrWaitFrame, or at once if the session does not run. A request of 0 Hz, or
/// any request while `ignores_rate` is set, changes nothing.
XrResult request_rate(XrSession session, float hertz) {
  const Session& found = need_session(session);
  const auto& rates = runtime().profile.rates;
  need(hertz == 0 || std::find(rates.begin(), rates.end(), hertz) != rates.end(),
       XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB, "a rate that is not listed");
  if (hertz == 0 || runtime().knobs.at("ignores_rate") != 0) return success(found);
  runtime().wanted_rate = hertz;
  if (!found.running) take_wanted_rate();
  return success(found);
}

}  // namespace

void change_rate(float hertz) {
  Runtime& all = runtime();
  XrEventDataDisplayRefreshRateChangedFB event{};
  event.fromDisplayRefreshRate = all.profile.rate;
  event.toDisplayRefreshRate = all.profile.rate = hertz;
  if (all.enabled.contains(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME))
    queue_event(event, XR_TYPE_EVENT_DATA_DISPLAY_REFRESH_RATE_CHANGED_FB);
}

void take_wanted_rate() {
  Runtime& all = runtime();
  const float wanted = std::exchange(all.wanted_rate, 0.0f);
  if (wanted != 0 && wanted != all.profile.rate) change_rate(wanted);
}

void add_rate_functions(Functions& functions) {
  if (!runtime().enabled.contains(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME)) return;
  add<"xrEnumerateDisplayRefreshRatesFB", enumerate_rates>(functions);
  add<"xrGetDisplayRefreshRateFB", get_rate>(functions);
  add<"xrRequestDisplayRefreshRateFB", request_rate>(functions);
}

}  // namespace simulated
