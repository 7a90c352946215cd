/// The one runtime of a process, its log, and checks that many calls share.

#include <cstdlib>
#include <fstream>

#include "tests/headset/parts.hpp"

namespace simulated {

std::mutex& lock() {
  static std::mutex one;
  return one;
}
std::condition_variable_any& frame_begun() {
  static std::condition_variable_any one;
  return one;
}
const char*& current_call() {
  thread_local const char* call = "";
  return call;
}

void log_line(const std::string& text) {
  static std::string open;
  static std::ofstream file;
  const char* path = std::getenv("VIP_XR_LOG");
  if (!path) return;
  if (open != path) {
    file.close();
    file.clear();
    file.open(path, std::ios::app);
    open = path;
  }
  file << text << std::endl;
}
void breach(const std::string& text) { log_line(std::string("BREACH ") + current_call() + ": " + text); }
void note(const std::string& text) { log_line(std::string("note ") + current_call() + ": " + text); }

Runtime& runtime() {
  static Runtime one;
  return one;
}

void restart() {
  const auto of = [](const char* name) {
    const char* text = std::getenv(name);
    return std::string(text ? text : "");
  };
  static std::string seen = "nothing";
  const std::string text = of("VIP_XR_PROFILE") + "\n" + of("VIP_XR_LOG");
  if (text == seen) return;
  seen = text;
  Runtime& all = runtime();
  all = Runtime{};
  all.profile = read_profile();
  all.knobs = all.profile.knobs;
  all.clock.real = all.profile.clock == "real";
  all.clock.now = ahead_of_monotonic + 5'000'000'000;
  all.clock.start = now();
  all.worn_from = now() + static_cast<XrTime>(1e9 * all.knobs.at("worn_after"));
}

void need_instance(XrInstance instance) {
  const Runtime& all = runtime();
  find(runtime().instances, instance, "instance");
  if (all.instance_lost_at >= 0 && all.frames >= all.instance_lost_at) fail(XR_ERROR_INSTANCE_LOST);
}

void need_system(XrInstance instance, XrSystemId system) {
  need_instance(instance);
  need(system == the_system && runtime().asked_system, XR_ERROR_SYSTEM_INVALID,
       "a system that xrGetSystem did not give");
}

Session& need_session(XrSession session) {
  const Runtime& all = runtime();
  Session& found = find(runtime().sessions, session, "session");
  if (all.instance_lost_at >= 0 && all.frames >= all.instance_lost_at) fail(XR_ERROR_INSTANCE_LOST);
  if (found.lost_at >= 0 && all.frames >= found.lost_at) fail(XR_ERROR_SESSION_LOST);
  return found;
}
void need_session_number(std::uint64_t session) { need_session(as_handle<XrSession>(session)); }

void need_views(XrViewConfigurationType kind) {
  need(kind == offered_views(), XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED,
       "a kind of views that is not listed");
}

void need_chain(const void* next) {
  static const std::map<int, std::string> extension_of{
      {XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT, XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME},
      {XR_TYPE_SYSTEM_USER_PRESENCE_PROPERTIES_EXT, XR_EXT_USER_PRESENCE_EXTENSION_NAME},
      {XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT, XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME},
      {XR_TYPE_GRAPHICS_BINDING_EGL_MNDX, XR_MNDX_EGL_ENABLE_EXTENSION_NAME},
      {XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR, XR_KHR_OPENGL_ENABLE_EXTENSION_NAME}};
  constexpr int first_of_extensions = 1'000'000'000;
  for (auto* one = static_cast<const XrBaseInStructure*>(next); one; one = one->next) {
    if (one->type < first_of_extensions) continue;
    const auto extension = extension_of.find(one->type);
    need(extension != extension_of.end() && runtime().enabled.contains(extension->second),
         XR_ERROR_VALIDATION_FAILURE, "a chained structure of an extension that is not enabled");
  }
}

void need_enabled(const char* extension) {
  need(runtime().enabled.contains(extension), XR_ERROR_FUNCTION_UNSUPPORTED,
       std::string(extension) + " is not enabled");
}

XrResult success(const Session& session) {
  const bool pending = runtime().profile.positive || session.state == XR_SESSION_STATE_LOSS_PENDING;
  return pending ? XR_SESSION_LOSS_PENDING : XR_SUCCESS;
}

}  // namespace simulated
