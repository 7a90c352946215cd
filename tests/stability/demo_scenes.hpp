#pragma once
/// The scenes of data/scenes that list effects.

#include <algorithm>
#include <filesystem>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "stats/base/file.hpp"

namespace stability_test {

inline std::vector<sim::Scene> scenes_with_effects() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(base::resource("data/scenes")))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<sim::Scene> out;
  for (const auto& file : files) {
    sim::Scene scene = sim::read_scene(file);
    if (!scene.effects.empty()) out.push_back(std::move(scene));
  }
  return out;
}

}  // namespace stability_test
