#include "tests/headset/profile.hpp"

#include <cstdlib>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "tests/headset/openxr.hpp"

namespace simulated {

namespace {

[[noreturn]] void unknown(const std::string& text) {
  throw std::invalid_argument("VIP_XR_PROFILE: " + text +
                              " is not known; tests/headset/README.md lists the keys");
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) {
    if (!part.empty()) out.push_back(part);
  }
  return out;
}

bool yes(const std::string& value) {
  if (value != "0" && value != "1") unknown(value);
  return value == "1";
}

std::string one_of(const std::string& value, const std::vector<std::string>& choices) {
  for (const std::string& choice : choices) {
    if (choice == value) return value;
  }
  unknown(value);
}

const std::map<std::string, std::int64_t> format_names{{"srgb8_alpha8", GL_SRGB8_ALPHA8},
                                                       {"rgba16f", GL_RGBA16F},
                                                       {"rgba8", GL_RGBA8},
                                                       {"rgb10_a2", GL_RGB10_A2},
                                                       {"depth32f", GL_DEPTH_COMPONENT32F}};
const std::map<std::string, std::string> format_lists{{"srgb_first", "srgb8_alpha8,rgba16f,rgba8,depth32f"},
                                                      {"linear_first", "rgba16f,rgba8,srgb8_alpha8"},
                                                      {"srgb_only", "srgb8_alpha8"}};

std::int64_t format_of(const std::string& name) {
  const auto found = format_names.find(name);
  if (found == format_names.end()) unknown(name);
  return found->second;
}

std::vector<std::int64_t> read_formats(const std::string& text) {
  const auto list = format_lists.find(text);
  std::vector<std::int64_t> out;
  for (const std::string& name : split(list == format_lists.end() ? text : list->second, ','))
    out.push_back(format_of(name));
  return out;
}

template <class T>
std::vector<T> read_numbers(const std::string& text) {
  std::vector<T> out;
  for (const std::string& number : split(text, ',')) out.push_back(static_cast<T>(std::stod(number)));
  return out;
}

/// Parses "0.5:0.4,0.5:0.9": places on a page, as fractions from its left and its top.
std::vector<std::pair<double, double>> read_targets(const std::string& text) {
  std::vector<std::pair<double, double>> out;
  for (const std::string& entry : split(text, ','))
    out.emplace_back(std::stod(entry), std::stod(entry.substr(entry.find(':') + 1)));
  return out;
}

/// Parses "100:focus/0,160:focus/1": frame, name and value of each event.
std::vector<ScriptedEvent> read_script(const std::string& text) {
  std::vector<ScriptedEvent> out;
  for (const std::string& entry : split(text, ',')) {
    const std::size_t colon = entry.find(':'), slash = entry.find('/');
    if (colon == std::string::npos) unknown(entry);
    ScriptedEvent event{std::stol(entry), entry.substr(colon + 1, slash - colon - 1), 1};
    if (slash != std::string::npos) event.value = std::stod(entry.substr(slash + 1));
    out.push_back(event);
  }
  return out;
}

using Text = const std::string&;
const std::map<std::string, std::function<void(Profile&, Text)>> keys{
    {"name", [](Profile& p, Text value) { p.runtime_name = value; }},
    {"headset",
     [](Profile& p, Text value) {
       p.headset = one_of(value, {"connected", "unavailable", "unsupported"});
     }},
    {"clock",
     [](Profile& p, Text value) {
       p.clock = one_of(value, {"virtual", "real"});
     }},
    {"head",
     [](Profile& p, Text value) {
       p.head = one_of(value, {"still", "turn", "walk"});
     }},
    {"look",
     [](Profile& p, Text value) {
       p.look = one_of(value, {"fixed", "sweep", "page"});
     }},
    {"point",
     [](Profile& p, Text value) {
       p.point = one_of(value, {"fixed", "page"});
     }},
    {"controller", [](Profile& p, Text value) { p.controller = value; }},
    {"targets", [](Profile& p, Text value) { p.targets = read_targets(value); }},
    {"leave_context",
     [](Profile& p, Text value) {
       p.leave_context = one_of(value, {"kept", "none", "other"});
     }},
    {"without",
     [](Profile& p, Text value) {
       for (Text name : split(value, ',')) std::erase(p.extensions, name);
     }},
    {"size",
     [](Profile& p, Text value) {
       p.width = static_cast<std::uint32_t>(std::stoul(value));
       p.height = static_cast<std::uint32_t>(std::stoul(value.substr(value.find('x') + 1)));
     }},
    {"rates", [](Profile& p, Text value) { p.rates = read_numbers<float>(value); }},
    {"rate", [](Profile& p, Text value) { p.rate = std::stof(value); }},
    {"formats", [](Profile& p, Text value) { p.formats = read_formats(value); }},
    {"broken", [](Profile& p, Text value) { p.broken_format = format_of(value); }},
    {"fov", [](Profile& p, Text value) { p.fov = read_numbers<double>(value); }},
    {"dump", [](Profile& p, Text value) { p.dumps = read_numbers<long>(value); }},
    {"at", [](Profile& p, Text value) { p.script = read_script(value); }},
    {"gaze", [](Profile& p, Text value) { p.gaze = yes(value); }},
    {"presence", [](Profile& p, Text value) { p.presence = yes(value); }},
    {"opaque", [](Profile& p, Text value) { p.opaque = yes(value); }},
    {"stereo", [](Profile& p, Text value) { p.stereo = yes(value); }},
    {"positive", [](Profile& p, Text value) { p.positive = yes(value); }},
    {"leave_error", [](Profile& p, Text value) { p.leave_error = yes(value); }},
    {"hash", [](Profile& p, Text value) { p.hash = yes(value); }},
};

/// Values that the script may change, with their defaults. README.md explains them.
const std::map<std::string, double> knobs{
    {"x", 0},
    {"y", 1.6},
    {"z", 0},
    {"yaw", 0},
    {"pitch", 0},
    {"roll", 0},
    {"ipd", 0.063},
    {"position", 1},
    {"orientation", 1},
    {"render", 1},
    {"jitter", 0},
    {"wrong_periods", 0},
    {"ignores_rate", 0},
    {"skips", 0},
    {"image_timeouts", 0},
    {"unfound", 0},
    {"recentre_lead", 0},
    {"worn_after", 0},
    {"patience", 10},
    {"select", 0},
    {"menu", 0},
    {"thumb_x", 0},
    {"thumb_y", 0},
    {"aim_yaw", 0},
    {"aim_pitch", 0},
    {"look_yaw", 0},
    {"look_pitch", 0},
    {"hold", 1},
    {"gaze_rate", 120},
    {"gaze_age", 0},
    {"gaze_active", 1},
    {"gaze_valid", 1},
    {"gaze_tracked", 1},
    {"blink_every", 0},
    {"blink_length", 0.15},
};
/// Names of script events that set no value of `knobs`.
const std::vector<std::string> happenings{
    "focus", "shown", "off",    "lost", "lost_now",    "instance_lost", "exit", "unknown",    "recentre",
    "rate",  "drop",  "repeat", "hang", "events_lost", "untimed",       "worn", "rate_untold"};

void check_script(const Profile& profile) {
  for (const ScriptedEvent& event : profile.script) {
    if (!profile.knobs.contains(event.name)) one_of(event.name, happenings);
  }
}

}  // namespace

Profile read_profile() {
  Profile out;
  out.formats = read_formats("srgb_first");
  out.knobs = knobs;
  out.extensions = {XR_KHR_OPENGL_ENABLE_EXTENSION_NAME,
                    XR_MNDX_EGL_ENABLE_EXTENSION_NAME,
                    XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME,
                    XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME,
                    XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME,
                    XR_EXT_USER_PRESENCE_EXTENSION_NAME,
                    "XR_BD_controller_interaction",
                    "XR_HTC_vive_focus3_controller_interaction",
                    "XR_EXT_hand_interaction",
                    "XR_EXTX_made_up"};
  const char* text = std::getenv("VIP_XR_PROFILE");
  for (const std::string& entry : split(text ? text : "", ';')) {
    const std::size_t at = entry.find('=');
    if (at == std::string::npos) unknown(entry);
    const std::string name = entry.substr(0, at), value = entry.substr(at + 1);
    if (const auto knob = out.knobs.find(name); knob != out.knobs.end()) {
      knob->second = std::stod(value);
      continue;
    }
    const auto key = keys.find(name);
    if (key == keys.end()) unknown(entry);
    key->second(out, value);
  }
  check_script(out);
  return out;
}

}  // namespace simulated
