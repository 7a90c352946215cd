#include "libstudy/runner/run_options.hpp"

#include <algorithm>
#include <limits>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

namespace {

constexpr int format_version = 2;

std::optional<double> optional_number(const base::Json& json) {
  if (json.is_null()) return {};
  return json.get<double>();
}

[[noreturn]] void unreadable(const std::string& place) {
  throw base::Error(place, "contains options of its run that cannot be read",
                    "restore a backup of the database");
}

/// Width or height of a display, px; 0: the whole monitor.
int side_of(const base::Json& json, const std::string& place) {
  const auto side = json.get<double>();
  if (side != 0 && !(side >= base::least_picture_side && side <= base::most_picture_side)) unreadable(place);
  return static_cast<int>(side);
}

int monitor_of(const base::Json& json, const std::string& place) {
  const auto found = json.find("monitor");
  if (found == json.end()) return 0;
  // Refuses numbers whose conversion to int would round or be undefined.
  if (!found->is_number_integer() || found->get<double>() < 0 ||
      found->get<double>() > std::numeric_limits<int>::max())
    unreadable(place);
  return found->get<int>();
}

std::array<double, 3> turn_of(const base::Json& json, const std::string& place) {
  std::array<double, 3> turn{};
  const auto found = json.find("gaze_turn_deg");
  if (found == json.end()) return turn;
  const auto angles = found->get<std::vector<double>>();
  if (angles.size() != turn.size()) unreadable(place);
  std::copy(angles.begin(), angles.end(), turn.begin());
  return turn;
}

/// Reads the solver settings; base::Error if a text does not match its recorded SHA-256, because the session
/// would then use other settings than recorded.
std::vector<std::string> settings_of(const base::Json& json, const std::string& place) {
  std::vector<std::string> out;
  const auto found = json.find("settings");
  if (found == json.end()) return out;
  for (const auto& one : *found) {
    out.push_back(one.at("text"));
    if (one.at("sha256") != base::sha256_hex(out.back())) unreadable(place);
  }
  return out;
}

}  // namespace

std::string format_run_options(const RunOptions& options) {
  base::Json json{{"format", format_version},
                  {"observer", options.observer},
                  {"clock", options.clock},
                  {"display", options.display},
                  {"width_px", options.width_px},
                  {"height_px", options.height_px},
                  {"monitor", options.monitor},
                  {"bake", options.bake},
                  {"backend", options.backend},
                  {"answer", options.answer},
                  {"gaze", options.gaze},
                  {"ignore_presence", options.ignore_presence},
                  {"accept_slow", options.accept_slow},
                  {"station", options.station},
                  {"screen_width_mm", options.screen_width_mm},
                  {"viewing_distance_mm", options.viewing_distance_mm}};
  if (options.light_patch) json["light_patch"] = true;
  if (options.gaze_turn_deg != std::array<double, 3>{}) json["gaze_turn_deg"] = options.gaze_turn_deg;
  for (const std::string& text : options.settings)
    json["settings"].push_back({{"sha256", base::sha256_hex(text)}, {"text", text}});
  return json.dump();
}

RunOptions parse_run_options(const std::string& text, const std::string& place) {
  try {
    const auto json = base::parse_json(text);
    if (json.at("format") != format_version) {
      throw base::Error(place, "contains run options of another format",
                        "resume it with the version of vip-study that wrote it");
    }
    RunOptions options;
    options.observer = json.at("observer");
    options.clock = json.at("clock");
    options.display = json.at("display");
    options.width_px = side_of(json.at("width_px"), place);
    options.height_px = side_of(json.at("height_px"), place);
    options.monitor = monitor_of(json, place);
    options.bake = json.at("bake");
    options.backend = json.at("backend");
    options.answer = json.value("answer", "");
    options.gaze = json.at("gaze");
    options.ignore_presence = json.value("ignore_presence", false);
    options.light_patch = json.value("light_patch", false);
    options.gaze_turn_deg = turn_of(json, place);
    options.accept_slow = json.value("accept_slow", false);
    options.station = json.at("station");
    options.screen_width_mm = optional_number(json.at("screen_width_mm"));
    options.viewing_distance_mm = optional_number(json.at("viewing_distance_mm"));
    options.settings = settings_of(json, place);
    return options;
  } catch (const base::Json::exception&) {
    unreadable(place);
  }
}

}  // namespace study
