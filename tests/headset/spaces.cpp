/// Spaces, and where they are. The runtime's own frame is STAGE: its origin lies on the floor.

#include "tests/headset/state.hpp"

namespace simulated {

namespace {

constexpr double eye_height = 1.6;

std::vector<XrReferenceSpaceType> offered_spaces() {
  return {XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL, XR_REFERENCE_SPACE_TYPE_STAGE};
}

Space& need_space(XrSpace space) {
  Space& found = find(runtime().spaces, space, "space");
  need_session(as_handle<XrSession>(found.session));
  return found;
}

XrResult enumerate_spaces(XrSession session, std::uint32_t capacity, std::uint32_t* count,
                          XrReferenceSpaceType* out) {
  const Session& found = need_session(session);
  const XrResult result = give_values(offered_spaces(), capacity, count, out);
  return result == XR_SUCCESS ? success(found) : result;
}

XrResult create_space(XrSession session, const XrReferenceSpaceCreateInfo* info, XrSpace* space) {
  const Session& found = need_session(session);
  need_type(info, XR_TYPE_REFERENCE_SPACE_CREATE_INFO);
  const auto offered = offered_spaces();
  need(std::find(offered.begin(), offered.end(), info->referenceSpaceType) != offered.end(),
       XR_ERROR_REFERENCE_SPACE_UNSUPPORTED, "a space that is not listed");
  need(is_valid(info->poseInReferenceSpace), XR_ERROR_POSE_INVALID, "a pose that is none");
  const Space fresh{number_of(session), info->referenceSpaceType, from_xr(info->poseInReferenceSpace)};
  *space = new_handle<XrSpace>(runtime().spaces, fresh);
  return success(found);
}

XrResult destroy_space(XrSpace space) {
  find(runtime().spaces, space, "space");
  runtime().spaces.erase(number_of(space));
  return XR_SUCCESS;
}

XrResult get_bounds(XrSession session, XrReferenceSpaceType type, XrExtent2Df* bounds) {
  const Session& found = need_session(session);
  const bool stage = type == XR_REFERENCE_SPACE_TYPE_STAGE;
  *bounds = stage ? XrExtent2Df{2, 2} : XrExtent2Df{0, 0};
  return stage ? success(found) : XR_SPACE_BOUNDS_UNAVAILABLE;
}

/// Where a space is in the runtime's own frame.
Pose place_of(const Space& space, XrTime time) {
  if (space.type == XR_REFERENCE_SPACE_TYPE_VIEW) return head_at(time) * space.offset;
  if (space.type == XR_REFERENCE_SPACE_TYPE_STAGE) return space.offset;
  return Pose{turned(runtime().local_yaw, 0, 0), {0, eye_height, 0}} * space.offset;
}

Placed to_placed(const Pose& pose, bool moves) {
  const auto& knobs = runtime().knobs;
  // What is not valid holds nothing that could be used.
  if (moves && knobs.at("orientation") == 0) return {0, {}};
  XrSpaceLocationFlags flags = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT |
                               XR_SPACE_LOCATION_POSITION_VALID_BIT |
                               XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
  if (!moves || knobs.at("position") != 0) flags |= XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
  return {flags, to_xr(pose)};
}

XrResult locate_space(XrSpace space, XrSpace base, XrTime time, XrSpaceLocation* out) {
  const Space &what = need_space(space), &from = need_space(base);
  need_type(out, XR_TYPE_SPACE_LOCATION);
  need_chain(out->next);
  need(time > 0, XR_ERROR_TIME_INVALID, "a time that is not positive");
  if (auto* velocity = find_chained<XrSpaceVelocity>(out->next, XR_TYPE_SPACE_VELOCITY))
    velocity->velocityFlags = 0;
  const Placed place = locate(what, from, time);
  out->locationFlags = place.flags;
  out->pose = place.pose;
  return success(runtime().sessions.at(what.session));
}

}  // namespace

Placed locate(const Space& what, const Space& from, XrTime time) {
  return to_placed(inverse(place_of(from, time)) * place_of(what, time), what.type != from.type);
}

Placed locate_eye(int eye, const Space& from, XrTime time) {
  return to_placed(inverse(place_of(from, time)) * eye_at(time, eye),
                   from.type != XR_REFERENCE_SPACE_TYPE_VIEW);
}

void add_space_functions(Functions& functions) {
  add<"xrEnumerateReferenceSpaces", enumerate_spaces>(functions);
  add<"xrCreateReferenceSpace", create_space>(functions);
  add<"xrDestroySpace", destroy_space>(functions);
  add<"xrGetReferenceSpaceBoundsRect", get_bounds>(functions);
  add<"xrLocateSpace", locate_space, Logged::frame_line>(functions);
}

}  // namespace simulated
