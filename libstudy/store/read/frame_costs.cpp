#include "libstudy/store/read/frame_costs.hpp"

#include <cmath>

#include "stats/base/error.hpp"
#include "stats/base/json.hpp"

namespace study {

std::string format_frame_costs(const std::vector<FrameCosts>& costs) {
  auto json = base::Json::array();
  for (const FrameCosts& one : costs) {
    json.push_back({{"scene", one.what.scene},
                    {"method", one.what.method},
                    {"n_star", one.what.n_star},
                    {"mean_ms", one.mean_ms},
                    {"p95_ms", one.p95_ms}});
    if (!one.what.effects.empty()) json.back()["effects"] = one.what.effects;
    if (!one.what.surface.empty()) json.back()["surface"] = one.what.surface;
  }
  return json.dump();
}

std::vector<FrameCosts> parse_frame_costs(const std::string& text, const std::string& place) {
  const auto unreadable = [&] {
    return base::Error(place, std::string("holds an event '") + frame_costs_event + "' that cannot be read",
                       "restore a backup of it");
  };
  try {
    std::vector<FrameCosts> out;
    const auto json = base::parse_json(text);
    if (!json.is_array()) throw unreadable();
    for (const auto& one : json) {
      out.push_back({{one.at("scene"), one.at("method"), one.at("n_star"), one.value("effects", ""),
                      one.value("surface", "")},
                     one.at("mean_ms"),
                     one.at("p95_ms")});
      if (!(out.back().mean_ms >= 0) || !(out.back().p95_ms >= 0)) throw unreadable();
    }
    return out;
  } catch (const base::Json::exception&) {
    throw unreadable();
  }
}

}  // namespace study
