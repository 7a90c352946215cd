/// vip-state-hashes [DATA_FOLDER [N_STAR [FRAMES]]] (default: data 512 200) prints hashes of the solver's
/// results, to compare two versions of the sources on one machine: three scenes, five methods, every 20th
/// frame, and the schedule of each. Ours-TSp runs at a fixed tau of -6 frames/s, so that particles rest. A
/// change that only moves code leaves every line unchanged.

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

/// A wavy surface in three quarters of the picture, so that every feature of saliency has something to read.
sim::GBuffer picture_of(const sim::Scene& scene, int frame) {
  constexpr int width = 96, height = 54;
  sim::GBuffer out;
  out.width = width;
  out.height = height;
  out.view = sim::make_view(scene.view, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool fluid = y < 3 * height / 4;
      const auto slope = static_cast<float>(0.6 * std::sin(0.3 * x + 0.05 * frame) * std::cos(0.2 * y));
      const float length = std::sqrt(1 + slope * slope);
      out.depth.push_back(fluid ? 3 + slope : std::numeric_limits<float>::infinity());
      for (const float n : {slope / length, 0.0f, 1 / length}) out.normal.push_back(fluid ? n : 0);
    }
  }
  out.filtered_depth = out.depth;
  out.thickness.assign(out.depth.size(), 0.5f);
  out.front.assign(out.depth.size(), sim::GBuffer::no_particle);
  out.radius.assign(out.depth.size(), 0.05f);
  return out;
}

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Hash of the particles, their saliency and a part of the report of a frame.
std::string hash_of(sim::Simulation& fluid) {
  std::string bytes;
  for (const auto& p : fluid.read_state()) append(bytes, p);
  for (const int id : fluid.read_ids()) append(bytes, id);
  std::vector<sim::ParticleSaliency> saliency;
  fluid.read_saliency(saliency);
  for (const auto& s : saliency) append(bytes, s);
  const sim::FrameReport report = fluid.report();
  append(bytes, report.guards);
  append(bytes, report.density_error_mean);
  append(bytes, report.neighbours_mean);
  append(bytes, report.levels);
  append(bytes, report.poured);
  append(bytes, report.temporal.active);
  return base::sha256_hex(bytes).substr(0, 16);
}

void run(const sim::Scene& scene, const sim::MethodTraits& method, std::int64_t n_star, int frames) {
  sim::SimulationOptions options;
  options.method = method.kind;
  options.n_star = n_star;
  options.saliency_parts = true;
  if (method.temporal) options.temporal.fixed_tau = -6;
  const auto fluid = sim::make_simulation(scene, options);
  const std::string who = scene.name + " " + method.name;
  std::cout << fluid->explain() << who << " 0 " << hash_of(*fluid) << "\n";
  for (int frame = 1; frame <= frames; ++frame) {
    const sim::GBuffer picture = picture_of(scene, frame);
    sim::EyeLook eye;
    eye.gaze = {scene.view.eye_m, {0.1 * std::sin(0.02 * frame), -0.1, -1}, frame % 50 != 0};
    eye.view = sim::make_view(scene.view, picture.width, picture.height);
    eye.seen = &picture;
    eye.seen_frame = frame - 1;
    fluid->look({{eye}});
    fluid->step_frame();
    if (frame % 20 == 0) std::cout << who << " " << frame << " " << hash_of(*fluid) << std::endl;
  }
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const std::string data = count > 1 ? arguments[1] : "data";
    const std::int64_t n_star = sim::parse_n_star(count > 2 ? arguments[2] : "512");
    const int frames = count > 3 ? std::atoi(arguments[3]) : 200;
    for (const char* name : {"single_dam", "jet_impact", "faucet"}) {
      const sim::Scene scene = sim::read_scene(data + "/scenes/" + name + ".toml");
      for (const auto& method : sim::all_methods()) run(scene, method, n_star, frames);
    }
  } catch (const base::Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
