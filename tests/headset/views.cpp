/// Poses of the eyes.

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

constexpr std::size_t remembered = 1200;

XrResult locate_views(XrSession session, const XrViewLocateInfo* info, XrViewState* state,
                      std::uint32_t capacity, std::uint32_t* count, XrView* views) {
  Session& found = need_session(session);
  need_type(info, XR_TYPE_VIEW_LOCATE_INFO);
  need_type(state, XR_TYPE_VIEW_STATE);
  need_views(info->viewConfigurationType);
  need(info->displayTime > 0, XR_ERROR_TIME_INVALID, "a time that is not positive");
  const Space& space = find(runtime().spaces, info->space, "space");
  Located located{info->space, {}, {}};
  const std::vector<int> eyes = runtime().profile.stereo ? std::vector{0, 1} : std::vector{0};
  const XrResult result = give_array(eyes, capacity, count, [&](std::size_t i, int eye) {
    need_type(&views[i], XR_TYPE_VIEW);
    const Placed place = locate_eye(eye, space, info->displayTime);
    state->viewStateFlags = place.flags;  // XrViewStateFlags has the same bits
    views[i].pose = located.poses[i] = place.pose;
    views[i].fov = located.fovs[i] = fov_of(eye);
  });
  if (result != XR_SUCCESS) return result;
  if (capacity > 0) found.located.push_back(located);
  if (found.located.size() > remembered) found.located.pop_front();
  return success(found);
}

}  // namespace

void add_view_functions(Functions& functions) {
  add<"xrLocateViews", locate_views, Logged::frame_line>(functions);
}

}  // namespace simulated
