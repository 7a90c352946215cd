#include "apps/study/framing_report.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

namespace apps {

void print_framing(const CheckReport& report) {
  std::printf("\nframing:\n");
  for (const FramedScene& one : report.scenes) {
    std::printf("  %s", describe_framing(one).c_str());
    for (const std::string& name : one.cut) std::printf("; %s leaves the picture", name.c_str());
    if (one.cut.empty())
      std::printf(one.scene.visible.empty() ? "; the scene declares nothing that must stay visible"
                                            : "; what must stay visible does");
    std::printf("\n");
  }
  for (const std::string& note : framing_notes(report.protocol, report.scenes))
    std::printf("  %s\n", note.c_str());
}

void add_framing(nlohmann::ordered_json& json, const CheckReport& report) {
  for (const FramedScene& one : report.scenes) {
    const auto& drawn = one.view.viewport;
    nlohmann::ordered_json framing{{"scene", one.file},
                                   {"width_px", drawn.width},
                                   {"height_px", drawn.height},
                                   {"camera_angle_deg", one.framing.camera_deg},
                                   {"visual_angle_deg", nullptr},
                                   {"angle_ratio", nullptr},
                                   {"cut", one.cut}};
    if (one.framing.visual_deg) {
      framing["visual_angle_deg"] = *one.framing.visual_deg;
      framing["angle_ratio"] = *one.framing.ratio();
    }
    json["framing"].push_back(framing);
  }
}

}  // namespace apps
