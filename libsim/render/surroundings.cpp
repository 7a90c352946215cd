#include "libsim/render/surroundings.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "libsim/render/render_passes.hpp"

namespace sim {

namespace {

constexpr int sky_px = 512;
constexpr GLuint sky_unit = 1;  // of surroundings.glsl
// The water is splatted larger than the particles; a pipe hides it up to this many radii of the mouth.
constexpr double pipe_per_mouth = 1.3;
constexpr double pipe_diameters = 40;  // length above the tank
constexpr double room_per_tank = 1.2, height_per_tank = 2.0, least_hall_m = 2.5;

/// Height of the hall of a room: it holds the tank and the scene's cameras.
double ceiling_of(const Scene& scene) {
  const double eyes = std::max({scene.view.eye_m[1], scene.overview.eye_m[1], 0.0});
  return std::max(height_per_tank * scene.tank_size_m[1] + least_hall_m, eyes + 1);
}

}  // namespace

std::vector<Pipe> pipes_of(const Scene& scene) {
  std::vector<Pipe> out;
  for (const Nozzle& nozzle : scene.nozzles) {
    const double mouth = nozzle.position_m[1];
    const double top = scene.light.environment == Environment::Room
                           ? std::max(ceiling_of(scene), mouth)
                           : std::max(scene.tank_size_m[1], mouth) + pipe_diameters * nozzle.diameter_m;
    const double half = (top - mouth) / 2;
    out.push_back({{nozzle.position_m[0], mouth + half, nozzle.position_m[2]},
                   pipe_per_mouth * nozzle.diameter_m / 2,
                   half});
  }
  return out;
}

Surroundings::Surroundings(const Scene& scene) {
  if (scene.light.environment == Environment::Sky) {
    paint_sky(scene.light.seed);
    return;
  }
  const Vec3d& tank = scene.tank_size_m;
  const double around = room_per_tank * std::max(tank[0], tank[2]) + least_hall_m;
  std::mt19937 random(static_cast<unsigned>(scene.light.seed));
  for (std::size_t k = 0; k < 3; ++k) {
    // The hall holds the tank and the scene's cameras.
    const auto [least, most] = std::minmax({scene.view.eye_m[k], scene.overview.eye_m[k], 0.0});
    const double high = k == 1 ? ceiling_of(scene) : tank[k] + around;
    hall_[k] = k == 1 ? 0 : static_cast<float>(std::min(-around, least - 1));
    hall_[4 + k] = static_cast<float>(std::max(high, most + 1));
    hall_[8 + k] = static_cast<float>(random() >> 8) / 16777216;
  }
}

void Surroundings::paint_sky(int seed) {
  glCreateTextures(GL_TEXTURE_2D, 1, &sky_);
  glTextureStorage2D(sky_, std::bit_width(static_cast<unsigned>(sky_px)), GL_RGBA8, sky_px, sky_px);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTextureParameteri(sky_, axis, GL_CLAMP_TO_EDGE);
  glTextureParameteri(sky_, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  const GlProgram paint = compute_program("environment.comp");
  paint.use();
  glUniform1ui(paint.uniform("seed"), static_cast<GLuint>(seed));
  glBindImageTexture(0, sky_, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  dispatch_pixels(sky_px, sky_px);
  glBindImageTexture(0, 0, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  glGenerateTextureMipmap(sky_);
  glUseProgram(0);
}

Surroundings::~Surroundings() { glDeleteTextures(1, &sky_); }

void Surroundings::bind(const GlProgram& program) const {
  if (sky_) return glBindTextureUnit(sky_unit, sky_);
  glUniformMatrix4fv(program.uniform("hall"), 1, GL_FALSE, hall_.data());
}

void Surroundings::unbind() { glBindTextureUnit(sky_unit, 0); }

}  // namespace sim
