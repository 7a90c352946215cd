/// Spaces and their poses. The runtime's own frame is STAGE, whose origin is on the floor.

#include "tests/headset/parts.hpp"

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
  const Space fresh{number_of(session), info->referenceSpaceType, from_xr(info->poseInReferenceSpace), 0, ""};
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

constexpr XrSpaceLocationFlags valid_bits =
    XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
constexpr XrSpaceLocationFlags tracked_bits =
    XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT | XR_SPACE_LOCATION_POSITION_TRACKED_BIT;

std::vector<std::string> sources(const Space& space) {
  if (!space.action) return {};
  return sources_of(runtime().sessions.at(space.session), space.action, space.subaction);
}
bool is_gaze(const Space& space) {
  const auto found = sources(space);
  return !found.empty() && found.front() == gaze_source;
}

Placed to_placed(const Pose& pose, bool moves) {
  const auto& knobs = runtime().knobs;
  // OpenXR leaves the value of an invalid pose undefined. Here all its components are 0.
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
  if (auto* sample = find_chained<XrEyeGazeSampleTimeEXT>(out->next, XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT))
    sample->time = is_gaze(what) && place.flags ? gaze_at(time).time : 0;
  out->locationFlags = place.flags;
  out->pose = place.pose;
  return success(runtime().sessions.at(what.session));
}

}  // namespace

Pose place_of(const Space& space, XrTime time) {
  if (space.action) return (is_gaze(space) ? gaze_at(time).pose : hand_at(time)) * space.offset;
  if (space.type == XR_REFERENCE_SPACE_TYPE_VIEW) return head_at(time) * space.offset;
  if (space.type == XR_REFERENCE_SPACE_TYPE_STAGE) return space.offset;
  double yaw = 0;
  for (const LocalTurn& turn : runtime().local_turns) yaw += turn.from <= time ? turn.degrees : 0;
  return Pose{turned(yaw, 0, 0), {0, eye_height, 0}} * space.offset;
}

Placed locate(const Space& what, const Space& from, XrTime time) {
  for (const Space* space : {&what, &from}) {
    if (space->action && sources(*space).empty()) return {0, {}};
  }
  const Pose pose = inverse(place_of(from, time)) * place_of(what, time);
  if (!is_gaze(what)) return to_placed(pose, what.action || from.action || what.type != from.type);
  const Gaze gaze = gaze_at(time);
  if (!gaze.valid) return {0, {}};
  // The eye tracker's samples of lower quality are VALID without TRACKED.
  return {valid_bits | (gaze.tracked ? tracked_bits : 0), to_xr(pose)};
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
