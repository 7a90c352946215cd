/// Poses of head, eyes, hand and gaze, and the participant's input.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <set>

#include "tests/headset/client.hpp"
#include "tests/headset/pose.hpp"

namespace simulated {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// The actions of a program that takes answers by ray, thumbstick and eyes.
struct Actions {
  explicit Actions(Client& of) : client(of) {
    auto set_info = blank<XrActionSetCreateInfo>(XR_TYPE_ACTION_SET_CREATE_INFO);
    std::strcpy(set_info.actionSetName, "answers");
    std::strcpy(set_info.localizedActionSetName, "Answers");
    client.call<PFN_xrCreateActionSet>("xrCreateActionSet")(client.instance, &set_info, &set);
    select = make("select", XR_ACTION_TYPE_BOOLEAN_INPUT);
    move = make("move", XR_ACTION_TYPE_VECTOR2F_INPUT);
    aim = make("aim", XR_ACTION_TYPE_POSE_INPUT);
    gaze = make("gaze", XR_ACTION_TYPE_POSE_INPUT);
  }
  XrPath path(const char* text) const {
    XrPath out = XR_NULL_PATH;
    client.call<PFN_xrStringToPath>("xrStringToPath")(client.instance, text, &out);
    return out;
  }
  XrAction make(const char* name, XrActionType type) const {
    auto info = blank<XrActionCreateInfo>(XR_TYPE_ACTION_CREATE_INFO);
    std::strcpy(info.actionName, name);
    std::strcpy(info.localizedActionName, name);
    info.actionType = type;
    XrAction out = XR_NULL_HANDLE;
    result = client.call<PFN_xrCreateAction>("xrCreateAction")(set, &info, &out);
    return out;
  }
  XrResult suggest(const char* profile, const std::vector<XrActionSuggestedBinding>& bindings) const {
    auto info = blank<XrInteractionProfileSuggestedBinding>(XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING);
    info.interactionProfile = path(profile);
    info.countSuggestedBindings = static_cast<std::uint32_t>(bindings.size());
    info.suggestedBindings = bindings.data();
    return client.call<PFN_xrSuggestInteractionProfileBindings>("xrSuggestInteractionProfileBindings")(
        client.instance, &info);
  }
  void suggest_all() const {
    suggest("/interaction_profiles/khr/simple_controller",
            {{select, path("/user/hand/left/input/select/click")},
             {select, path("/user/hand/right/input/select/click")},
             {aim, path("/user/hand/right/input/aim/pose")}});
    suggest("/interaction_profiles/oculus/touch_controller",
            {{select, path("/user/hand/right/input/trigger/value")},
             {move, path("/user/hand/right/input/thumbstick")},
             {aim, path("/user/hand/right/input/aim/pose")}});
    suggest("/interaction_profiles/ext/eye_gaze_interaction",
            {{gaze, path("/user/eyes_ext/input/gaze_ext/pose")}});
  }
  XrResult attach() const {
    auto info = blank<XrSessionActionSetsAttachInfo>(XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO);
    info.countActionSets = 1;
    info.actionSets = &set;
    return client.call<PFN_xrAttachSessionActionSets>("xrAttachSessionActionSets")(client.session, &info);
  }
  XrSpace space(XrAction action) const {
    auto info = blank<XrActionSpaceCreateInfo>(XR_TYPE_ACTION_SPACE_CREATE_INFO);
    info.action = action;
    info.poseInActionSpace.orientation.w = 1;
    XrSpace out = XR_NULL_HANDLE;
    client.call<PFN_xrCreateActionSpace>("xrCreateActionSpace")(client.session, &info, &out);
    return out;
  }
  XrResult sync() const {
    const XrActiveActionSet active{set, XR_NULL_PATH};
    auto info = blank<XrActionsSyncInfo>(XR_TYPE_ACTIONS_SYNC_INFO);
    info.countActiveActionSets = 1;
    info.activeActionSets = &active;
    return client.call<PFN_xrSyncActions>("xrSyncActions")(client.session, &info);
  }
  template <class State, class Function>
  State get(Function function, XrAction action, XrStructureType type) const {
    auto info = blank<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
    info.action = action;
    auto state = blank<State>(type);
    result = function(client.session, &info, &state);
    return state;
  }
  XrActionStateBoolean pressed() const {
    return get<XrActionStateBoolean>(client.call<PFN_xrGetActionStateBoolean>("xrGetActionStateBoolean"),
                                     select, XR_TYPE_ACTION_STATE_BOOLEAN);
  }
  XrActionStateVector2f moved() const {
    return get<XrActionStateVector2f>(client.call<PFN_xrGetActionStateVector2f>("xrGetActionStateVector2f"),
                                      move, XR_TYPE_ACTION_STATE_VECTOR2F);
  }

  Client& client;
  XrActionSet set = XR_NULL_HANDLE;
  XrAction select, move, aim, gaze;
  mutable XrResult result = XR_SUCCESS;
};

/// A focused client with attached actions.
struct Participant : Client {
  explicit Participant(const std::string& profile) : Client(profile), actions(*this) {
    actions.suggest_all();
    EXPECT_EQ(actions.attach(), XR_SUCCESS);
    aim = actions.space(actions.aim);
    gaze = actions.space(actions.gaze);
    frames_until(XR_SESSION_STATE_FOCUSED);
    EXPECT_EQ(actions.sync(), XR_SUCCESS);
  }
  Actions actions;
  XrSpace aim, gaze;
};

TEST(PlaceGl, EyesStandApartAndSeeAsymmetrically) {
  Client client("ipd=0.07;at=6:ipd/0.06");
  client.frames_until(XR_SESSION_STATE_FOCUSED);
  std::array<XrView, 2> views;
  XrViewState state;
  client.locate(views, state);
  EXPECT_NEAR(views[1].pose.position.x - views[0].pose.position.x, 0.07, 1e-6);
  EXPECT_FLOAT_EQ(views[0].fov.angleLeft, -views[1].fov.angleRight);
  EXPECT_NE(views[0].fov.angleRight, -views[0].fov.angleLeft);
  for (int i = 0; i < 6; ++i) client.frame();
  client.locate(views, state);
  EXPECT_NEAR(views[1].pose.position.x - views[0].pose.position.x, 0.06, 1e-6);
}

TEST(PlaceGl, TheHeadWalksAndTurns) {
  Client client("head=walk");
  const XrSpace view = client.make_space(XR_REFERENCE_SPACE_TYPE_VIEW);
  client.frames_until(XR_SESSION_STATE_FOCUSED);
  const XrTime time = client.state.predictedDisplayTime;
  const XrPosef first = client.locate(view, client.local, time).pose;
  const XrPosef later = client.locate(view, client.local, time + 1'000'000'000).pose;
  EXPECT_GT(std::fabs(later.position.x - first.position.x), 0.1);
  EXPECT_GT(std::fabs(later.orientation.y - first.orientation.y), 0.1);
  EXPECT_TRUE(is_valid(later));
}

TEST(PlaceGl, TrackingIsLostInPart) {
  Client client("at=5:position/0,8:orientation/0,11:orientation/1");
  std::vector<XrViewStateFlags> flags;
  for (int i = 0; i < 14; ++i) {
    client.frame();
    std::array<XrView, 2> views;
    XrViewState state;
    client.locate(views, state);
    if (flags.empty() || flags.back() != state.viewStateFlags) flags.push_back(state.viewStateFlags);
  }
  EXPECT_THAT(flags, ElementsAre(15, 7, 0, 7));
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
}

TEST(PlaceGl, ClicksAndThumbstickFollowTheScript) {
  Participant client("controller=oculus/touch_controller;at=6:select/1,8:select/0,9:thumb_x/0.75");
  std::vector<int> clicks;
  while (client.lines("frame").size() < 12) {
    client.frame();
    client.actions.sync();
    const XrActionStateBoolean state = client.actions.pressed();
    EXPECT_TRUE(state.isActive);
    if (state.changedSinceLastSync) clicks.push_back(state.currentState ? 1 : 0);
  }
  EXPECT_THAT(clicks, ElementsAre(1, 0));
  EXPECT_FLOAT_EQ(client.actions.moved().currentState.x, 0.75f);
  EXPECT_EQ(client.locate(client.aim, client.local, client.state.predictedDisplayTime).locationFlags, 15u);
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
}

TEST(PlaceGl, NothingIsActiveWithoutFocus) {
  Participant client("at=6:focus/0");
  for (int i = 0; i < 8; ++i) client.frame();
  EXPECT_EQ(client.actions.sync(), XR_SESSION_NOT_FOCUSED);
  EXPECT_FALSE(client.actions.pressed().isActive);
  EXPECT_EQ(client.locate(client.gaze, client.local, client.state.predictedDisplayTime).locationFlags, 0u);
}

TEST(PlaceGl, GazeComesOnItsOwnGridWithBlinksAndPoorSamples) {
  Participant client("gaze_rate=50;blink_every=1;blink_length=0.1;look_yaw=10;at=120:gaze_tracked/0");
  std::set<XrTime> times;
  std::map<XrSpaceLocationFlags, int> flags;
  for (int i = 0; i < 180; ++i) {
    client.frame();
    client.actions.sync();
    auto sample = blank<XrEyeGazeSampleTimeEXT>(XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT);
    const auto place = client.locate(client.gaze, client.local, client.state.predictedDisplayTime, &sample);
    ++flags[place.locationFlags];
    EXPECT_EQ(place.locationFlags == 0, sample.time == 0);
    if (sample.time) times.insert(sample.time);
    EXPECT_LT(sample.time, client.state.predictedDisplayTime);
    if (place.locationFlags) {
      EXPECT_NEAR(place.pose.orientation.y, std::sin(5 * radians_per_degree), 1e-6);
    }
  }
  // 180 frames at 90 Hz are 2 s: 100 samples, a tenth of which fall into blinks.
  EXPECT_NEAR(static_cast<double>(times.size()), 90, 5);
  for (const XrTime time : times) EXPECT_EQ((time - *times.begin()) % 20'000'000, 0);
  EXPECT_GT(flags[0], 10);
  EXPECT_GT(flags[3], 40);
  EXPECT_GT(flags[15], 90);
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
}

TEST(PlaceGl, WithoutAnEyeTrackerThereIsNoGaze) {
  Participant client("gaze=0");
  EXPECT_EQ(client.locate(client.gaze, client.local, client.state.predictedDisplayTime).locationFlags, 0u);
}

/// Where a pose's ray meets the plane z = -1 of its space.
std::pair<double, double> hit(const XrPosef& pose) {
  const Pose ray = from_xr(pose);
  const Vector way = turn(ray.q, {0, 0, -1});
  const double length = (-1 - ray.p.z) / way.z;
  return {ray.p.x + length * way.x, ray.p.y + length * way.y};
}

TEST(PlaceGl, HandAndEyesPointAtThePage) {
  Participant client("point=page;look=page;targets=0.25:0.5,0.5:0.875;hold=0.5");
  auto quad = blank<XrCompositionLayerQuad>(XR_TYPE_COMPOSITION_LAYER_QUAD);
  quad.space = client.local;
  quad.subImage.swapchain = client.swapchains[0];
  quad.subImage.imageRect.extent = {64, 48};
  quad.pose = {{0, 0, 0, 1}, {0, 0, -1}};
  quad.size = {0.8f, 0.4f};
  std::vector<int> clicks;
  for (int i = 0; i < 90; ++i) {
    client.frame([&](Drawing& d) {
      d.layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&quad));
    });
    client.actions.sync();
    const auto state = client.actions.pressed();
    const XrTime time = client.state.predictedDisplayTime - 3 * client.state.predictedDisplayPeriod / 2;
    const auto [x, y] = hit(client.locate(client.aim, client.local, time).pose);
    if (state.changedSinceLastSync && state.currentState) clicks.push_back(x < -0.1 ? 0 : 1);
    EXPECT_TRUE((std::fabs(x + 0.2) < 1e-5 && std::fabs(y) < 1e-5) ||
                (std::fabs(x) < 1e-5 && std::fabs(y + 0.15) < 1e-5))
        << x << " " << y;
    const auto [u, v] = hit(client.locate(client.gaze, client.local, time).pose);
    EXPECT_TRUE(std::fabs(v) < 1e-5 || std::fabs(v + 0.15) < 1e-5) << u << " " << v;
  }
  EXPECT_THAT(clicks, ElementsAre(0, 1));
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
}

TEST(ActionBreachGl, ActionsAndBindingsAfterTheSetWasAttached) {
  Participant client("");
  client.actions.make("late", XR_ACTION_TYPE_BOOLEAN_INPUT);
  EXPECT_EQ(client.actions.result, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
  EXPECT_EQ(
      client.actions.suggest("/interaction_profiles/khr/simple_controller",
                             {{client.actions.aim, client.actions.path("/user/hand/left/input/aim/pose")}}),
      XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
  EXPECT_EQ(client.actions.attach(), XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
  EXPECT_THAT(
      client.lines("BREACH"),
      ElementsAre("BREACH xrCreateAction: an action after its set was attached",
                  "BREACH xrSuggestInteractionProfileBindings: a binding after the action's set was attached",
                  "BREACH xrAttachSessionActionSets: action sets are attached already"));
}

TEST(ActionBreachGl, NamesPathsTypesAndSetsAreChecked) {
  Client client;
  Actions actions(client);
  EXPECT_EQ(actions.suggest("/interaction_profiles/khr/simple_controller",
                            {{actions.move, actions.path("/user/hand/right/input/thumbstick")}}),
            XR_ERROR_PATH_UNSUPPORTED);
  EXPECT_EQ(actions.path("no path"), XrPath{XR_NULL_PATH});
  actions.make("select", XR_ACTION_TYPE_BOOLEAN_INPUT);
  EXPECT_EQ(actions.result, XR_ERROR_NAME_DUPLICATED);
  client.frames_until(XR_SESSION_STATE_FOCUSED);
  EXPECT_EQ(actions.sync(), XR_ERROR_ACTIONSET_NOT_ATTACHED);
  actions.attach();
  actions.get<XrActionStateBoolean>(client.call<PFN_xrGetActionStateBoolean>("xrGetActionStateBoolean"),
                                    actions.move, XR_TYPE_ACTION_STATE_BOOLEAN);
  EXPECT_EQ(actions.result, XR_ERROR_ACTION_TYPE_MISMATCH);
  EXPECT_THAT(client.lines("BREACH"), SizeIs(5));
}

}  // namespace
}  // namespace simulated
