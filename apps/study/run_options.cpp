#include "apps/study/run_options.hpp"

#include <nlohmann/json.hpp>

#include "stats/base/error.hpp"

namespace apps {

namespace {
constexpr int format_version = 1;
}

std::string format_run_options(const RunOptions& options) {
  return nlohmann::ordered_json{{"format", format_version},     {"observer", options.observer},
                                {"clock", options.clock},       {"display", options.display},
                                {"width_px", options.width_px}, {"height_px", options.height_px},
                                {"bake", options.bake},         {"backend", options.backend}}
      .dump();
}

RunOptions parse_run_options(const std::string& text, const std::string& place) {
  try {
    const auto json = nlohmann::json::parse(text);
    if (json.at("format").get<int>() != format_version) {
      throw base::Error(place, "options of another format", "use the version of vip-study that wrote it");
    }
    RunOptions options;
    options.observer = json.at("observer");
    options.clock = json.at("clock");
    options.display = json.at("display");
    options.width_px = json.at("width_px");
    options.height_px = json.at("height_px");
    options.bake = json.at("bake");
    options.backend = json.at("backend");
    return options;
  } catch (const nlohmann::json::exception& error) {
    throw base::Error(place, std::string("options of its run cannot be read: ") + error.what(),
                      "restore a backup of it");
  }
}

}  // namespace apps
