#include "libstudy/headset/offer.hpp"

#include <algorithm>
#include <tuple>

#include "libstudy/headset/refresh.hpp"
#include "libstudy/headset/session_handle.hpp"

namespace study {

namespace {

void read_instance(const XrConnection& xr, HeadsetOffer& out) {
  std::tie(out.runtime, out.runtime_version) = read_runtime(xr);
  out.extensions = xr.offered();
  std::sort(out.extensions.begin(), out.extensions.end());
  out.time_converts = xr.has(XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME);
}

/// Reads properties that only a session reports. This session is never begun: it shows nothing and needs no
/// frames.
void read_in_session(const XrConnection& xr, const HeadsetSystem& system, HeadsetOffer& out) {
  std::optional<sim::GlContext> gl;
  try {
    gl.emplace(make_headset_context());
  } catch (const base::Error& error) {
    const std::string said = error.what();
    out.no_session = said.substr(0, said.find('\n'));
    return;
  }
  const SessionHandle session(xr, system.id, *gl);
  HeadsetOffer::InSession found;
  found.formats = session.formats();
  const RefreshControl refresh(session);
  found.refresh_hz = refresh.rates();
  if (found.refresh_hz.size() > 1) found.refresh_now = refresh.reported_hz();
  out.session = found;
}

}  // namespace

HeadsetOffer read_headset_offer() {
  const XrConnection xr = connect_to_headset();
  HeadsetOffer out;
  read_instance(xr, out);
  const HeadsetSystem system = read_system(xr);
  out.headset = system.name;
  out.position = system.position;
  out.eye_gaze = system.eye_gaze;
  out.user_presence = system.user_presence;
  out.opaque = system.opaque;
  for (const auto& view : system.views)
    out.eyes.push_back({view.recommendedImageRectWidth, view.recommendedImageRectHeight});
  read_in_session(xr, system, out);
  return out;
}

}  // namespace study
