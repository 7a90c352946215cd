#include <cstdlib>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "tests/headset/state.hpp"

namespace simulated {

namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) {
    if (!part.empty()) out.push_back(part);
  }
  return out;
}

bool yes(const std::string& value) {
  if (value != "0" && value != "1")
    throw std::invalid_argument("VIP_XR_PROFILE: " + value + " is not 0 or 1");
  return value == "1";
}

const std::map<std::string, std::vector<std::int64_t>> format_lists{
    {"srgb_first", {GL_SRGB8_ALPHA8, GL_RGBA16F, GL_RGBA8, GL_DEPTH_COMPONENT32F}},
    {"linear_first", {GL_RGBA16F, GL_RGBA8, GL_SRGB8_ALPHA8}},
    {"srgb_only", {GL_SRGB8_ALPHA8}},
};

const std::map<std::string, std::function<void(Profile&, const std::string&)>> keys{
    {"name", [](Profile& p, const std::string& value) { p.runtime_name = value; }},
    {"headset", [](Profile& p, const std::string& value) { p.headset = value; }},
    {"without",  // extensions that are not offered, with commas between
     [](Profile& p, const std::string& value) {
       for (const std::string& name : split(value, ',')) std::erase(p.extensions, name);
     }},
    {"rates",
     [](Profile& p, const std::string& value) {
       p.rates.clear();
       for (const std::string& rate : split(value, ',')) p.rates.push_back(std::stof(rate));
     }},
    {"rate", [](Profile& p, const std::string& value) { p.rate = std::stof(value); }},
    {"formats", [](Profile& p, const std::string& value) { p.formats = format_lists.at(value); }},
    {"gaze", [](Profile& p, const std::string& value) { p.gaze = yes(value); }},
    {"position", [](Profile& p, const std::string& value) { p.position = yes(value); }},
    {"opaque", [](Profile& p, const std::string& value) { p.opaque = yes(value); }},
    {"stereo", [](Profile& p, const std::string& value) { p.stereo = yes(value); }},
    {"positive", [](Profile& p, const std::string& value) { p.positive = yes(value); }},
};

}  // namespace

Profile read_profile() {
  Profile out;
  out.formats = format_lists.at("srgb_first");
  out.extensions = {XR_KHR_OPENGL_ENABLE_EXTENSION_NAME,         XR_MNDX_EGL_ENABLE_EXTENSION_NAME,
                    XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME, XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME,
                    XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME,   "XR_EXTX_made_up"};
  const char* text = std::getenv("VIP_XR_PROFILE");
  for (const std::string& entry : split(text ? text : "", ';')) {
    const std::size_t at = entry.find('=');
    const auto key = keys.find(entry.substr(0, at));
    if (key == keys.end() || at == std::string::npos)
      throw std::invalid_argument("VIP_XR_PROFILE: " + entry + " is not known");
    key->second(out, entry.substr(at + 1));
  }
  return out;
}

}  // namespace simulated
