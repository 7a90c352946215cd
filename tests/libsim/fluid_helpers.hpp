#pragma once
/// Helpers for tests of the fluid: runs of small scenes, and measurements on the host that are independent of
/// the solver's own.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <unordered_map>
#include <vector>

#include "libsim/cases/water.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace fluid_test {

using sim::ParticleState;

/// A tank with a block of water, made without a scene file.
inline sim::Scene tank(sim::Vec3d size, sim::Vec3d water, int settle_frames = 0) {
  sim::Scene scene;
  scene.name = "test tank";
  scene.tank_size_m = size;
  scene.water.front().max_m = water;
  scene.settle_frames = settle_frames;
  return scene;
}

using sim::cases::centre_height;
using sim::cases::outside;
using sim::cases::rms_speed;

/// The error of reading this scene; "no error" if there is none.
inline std::string scene_error(const std::string& text) {
  try {
    sim::parse_scene(text, "scene.toml");
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

/// Neighbours of each particle within `radius_m`, counted over a host-side map of cells.
inline std::vector<int> neighbour_counts(const std::vector<ParticleState>& state, double radius_m) {
  const auto at = [&](float x) {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(x) / radius_m));
  };
  // Room for at most 2^20 cells a side.
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) { return (x << 42) + (y << 21) + z; };
  std::unordered_map<std::int64_t, std::vector<int>> cells;
  for (std::size_t i = 0; i < state.size(); ++i) {
    cells[key(at(state[i].x_m), at(state[i].y_m), at(state[i].z_m))].push_back(static_cast<int>(i));
  }
  std::vector<int> out(state.size(), 0);
  for (std::size_t i = 0; i < state.size(); ++i) {
    for (int n = 0; n < 27; ++n) {
      const auto found = cells.find(
          key(at(state[i].x_m) + n % 3 - 1, at(state[i].y_m) + n / 3 % 3 - 1, at(state[i].z_m) + n / 9 - 1));
      if (found == cells.end()) continue;
      for (const int j : found->second) {
        const auto& a = state[i];
        const auto& b = state[static_cast<std::size_t>(j)];
        const double d = std::hypot(static_cast<double>(a.x_m - b.x_m), static_cast<double>(a.y_m - b.y_m),
                                    static_cast<double>(a.z_m - b.z_m));
        out[i] += j != static_cast<int>(i) && d < radius_m;
      }
    }
  }
  return out;
}

/// Columns, by the names in the header line, of a CSV file whose other lines are numbers or comments (#).
inline std::map<std::string, std::vector<double>> read_columns(const std::string& resource) {
  std::istringstream in(base::read_file(base::resource(resource), 1 << 20));
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> out;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    if (names.empty()) {
      names = row;
    } else {
      for (std::size_t c = 0; c < names.size(); ++c) out[names[c]].push_back(std::stod(row.at(c)));
    }
  }
  return out;
}

}  // namespace fluid_test
