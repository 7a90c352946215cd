#pragma once
/// Small bakes for tests: a swaying block of particles and pictures of moving gradients. The random numbers
/// of each frame have the frame as their seed.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "libsim/bake/bake_file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace bake_test {

inline sim::BakeHeader header(std::int64_t frames, int width = 0, int height = 0) {
  sim::BakeHeader h;
  h.scene_name = "test";
  h.scene_sha256 = std::string(64, 'a');
  h.scene_text = "name = \"test\"\n";
  h.method = "HiRes";
  h.backend = "cpu";
  h.program_version = "0";
  h.n_star = 64;
  h.max_particles = 100'000;
  h.frame_count = frames;
  h.frame_dt_s = 1.0 / 60;
  h.tank_size_m = {19.2, 9, 12.8};
  h.radius_by_level_m = {0.05F, 0.1F};
  h.picture_width_px = width;
  h.picture_height_px = height;
  h.camera = width ? "view" : "";
  h.view = {64, 36, 75, 27.5, "test, OpenGL 4.5", "scene", {{0, {1, 2, 3}}, {60, {4, 5, 6}}}};
  h.tolerance = {{20, 5}, {31, 0.035}, 7};
  return h;
}

/// A jittered lattice over 19 x 7 x 12 m that sways with the frame; every fifth particle is of the coarser
/// level.
inline std::vector<sim::RenderParticle> particles(std::int64_t frame, int nx = 12, int ny = 8, int nz = 10) {
  std::vector<sim::RenderParticle> out;
  std::mt19937 random(static_cast<unsigned>(frame));
  std::uniform_real_distribution<float> jitter(-0.1F, 0.1F);
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      for (int z = 0; z < nz; ++z) {
        const float sway = std::sin(0.1F * static_cast<float>(frame));
        sim::RenderParticle p;
        p.x_m = 19 * static_cast<float>(x) / static_cast<float>(nx) + sway + jitter(random);
        p.y_m = 7 * static_cast<float>(y) / static_cast<float>(ny) + jitter(random);
        p.z_m = 12 * static_cast<float>(z) / static_cast<float>(nz) + jitter(random);
        p.radius_m = out.size() % 5 == 4 ? 0.1F : 0.05F;
        out.push_back(p);
      }
    }
  }
  return out;
}

/// Accounts of three kinds of frames in turn: empty, with a tau that was given and so has no frame rate, and
/// with everything.
inline sim::FrameAccount account(std::int64_t frame) {
  sim::FrameAccount out;
  if (frame % 3 == 0) return out;
  const auto count = static_cast<std::uint64_t>(frame);
  out.guards = sim::GuardCounts{count, 2 * count, 3, 4, 5, 6, 7, 8 * count};
  out.temporal = sim::TemporalReport{-0.5 * static_cast<double>(frame), {}, 0.625, 900 - frame};
  if (frame % 3 == 2) out.temporal->rate = sim::FrameRate{17.25, 3.5};
  return out;
}

/// A still gradient with a moving noisy disc.
inline sim::Bytes picture(std::int64_t frame, int width, int height) {
  sim::Bytes out;
  std::mt19937 random(static_cast<unsigned>(frame) + 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto dx = x - (width / 4 + static_cast<int>(frame) % (width / 2));
      const auto dy = y - height / 2;
      const auto noise = static_cast<unsigned>(16 * (dx * dx + dy * dy) < width * width ? random() % 40 : 0);
      for (const unsigned base : {static_cast<unsigned>(x), static_cast<unsigned>(y), 77U}) {
        out.push_back(static_cast<std::uint8_t>(base + noise));
      }
      out.push_back(255);
    }
  }
  return out;
}

inline void write(const std::filesystem::path& path, std::int64_t frames, int width = 0, int height = 0) {
  sim::BakeWriter writer(path, header(frames, width, height), true);
  for (std::int64_t i = 0; i < frames; ++i) {
    writer.add_frame(static_cast<double>(i) / 60, particles(i), account(i));
    if (width) writer.add_picture(picture(i, width, height));
  }
  writer.finish();
}

inline sim::Bytes read_all(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

using Folder = ::test::TemporaryFolder;

inline std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace bake_test
