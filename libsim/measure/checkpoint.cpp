#include "libsim/measure/checkpoint.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "libsim/scene/gaze.hpp"
#include "stats/base/error.hpp"

namespace measure {

namespace {

/// Hashes its arguments (rounds of lowbias32, C. Wellons).
std::uint32_t mixed(std::uint32_t a, std::uint32_t b) {
  std::uint32_t x = a * 0x9e3779b9u + b;
  for (int round = 0; round < 2; ++round) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
  }
  return x ^ (x >> 16);
}

float moved(float value, bool up) {
  constexpr float far = std::numeric_limits<float>::infinity();
  return std::nextafter(value, up ? far : -far);
}

}  // namespace

std::vector<sim::Vec3d> gaze_points(const sim::Scene& scene, int frame, int count) {
  std::vector<sim::Vec3d> out{sim::gaze_point(scene, frame)};
  auto keys = scene.gaze;
  std::stable_sort(keys.begin(), keys.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.frame - frame) < std::abs(b.frame - frame);
  });
  for (const auto& key : keys) {
    if (std::find(out.begin(), out.end(), key.point_m) == out.end()) out.push_back(key.point_m);
  }
  if (out.size() < static_cast<std::size_t>(count)) {
    throw base::Error("--gazes " + std::to_string(count),
                      scene.name + " names " + std::to_string(out.size()) + " gaze points",
                      "use at most " + std::to_string(out.size()));
  }
  out.resize(static_cast<std::size_t>(count));
  return out;
}

std::vector<sim::ParticleState> perturbed(const std::vector<sim::ParticleState>& state, int repeat) {
  auto out = state;
  if (repeat == 0) return out;
  for (auto& particle : out) {
    const std::uint32_t bits =
        mixed(static_cast<std::uint32_t>(particle.id), static_cast<std::uint32_t>(repeat));
    particle.x_m = moved(particle.x_m, bits & 1u);
    particle.y_m = moved(particle.y_m, bits & 2u);
    particle.z_m = moved(particle.z_m, bits & 4u);
  }
  return out;
}

std::vector<std::uint8_t> targets_by_id(const std::vector<sim::ParticleState>& state,
                                        const std::vector<int>& ids,
                                        const std::vector<sim::ParticleSaliency>& values) {
  constexpr std::uint8_t none = 255;
  const int most = ids.empty() ? -1 : *std::max_element(ids.begin(), ids.end());
  std::vector<std::uint8_t> by_id(static_cast<std::size_t>(most + 1), none);
  for (std::size_t i = 0; i < ids.size(); ++i)
    by_id[static_cast<std::size_t>(ids[i])] = static_cast<std::uint8_t>(values.at(i).target);
  std::vector<std::uint8_t> out;
  for (const auto& particle : state) {
    if (particle.id > most || by_id[static_cast<std::size_t>(particle.id)] == none)
      throw base::Error("start", "particle " + std::to_string(particle.id) + " has no target",
                        "give a target for each particle");
    out.push_back(by_id[static_cast<std::size_t>(particle.id)]);
  }
  return out;
}

}  // namespace measure
