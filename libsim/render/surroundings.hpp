#pragma once
/// What stands around the water in pictures: the environment of the tank, and the pipes of nozzles. Internal
/// to the renderer.

#include <array>
#include <vector>

#include "libsim/gl/gl_program.hpp"
#include "libsim/scene/scene.hpp"

namespace sim {

/// An upright cylinder with flat ends.
struct Pipe {
  Vec3d centre_m{};
  double radius_m = 0, half_length_m = 0;
};

/// The pipes through which the nozzles are fed, so that no jet begins in mid-air: from each mouth upwards,
/// into the ceiling of a room, or to a height of many diameters. Only pictures have them.
std::vector<Pipe> pipes_of(const Scene& scene);

/// Environment of a scene (SceneLight::environment) for shaders/surroundings.glsl. Needs a current context at
/// every call and when destroyed.
class Surroundings {
 public:
  explicit Surroundings(const Scene& scene);
  ~Surroundings();
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

  /// #define lines for programs that include surroundings.glsl.
  const char* defines() const { return sky_ ? "" : "#define ROOM\n"; }
  /// Sets what a program in use needs.
  void bind(const GlProgram& program) const;
  static void unbind();

 private:
  void paint_sky(int seed);

  unsigned sky_ = 0;              // texture; 0 in a room
  std::array<float, 16> hall_{};  // as in surroundings.glsl
};

}  // namespace sim
