#pragma once
/// Bodies without water, set up as the stage for contacts between bodies expects them.

#include <vector>

#include "libsim/particles/meeting.hpp"

namespace sim::SIM_BACKEND {

class BodiesApart {
 public:
  float dt = 1.0f / 180;
  float gravity = 0;
  Walls walls{};

  static Body sphere(Vec3 at, float radius) { return {{0, 0, 0}, radius, at, {0, 0, 0, 1}, {}, {}}; }
  static Body box(Vec3 at, Vec3 size) { return {0.5f * size, 0, at, {0, 0, 0, 1}, {}, {}}; }
  static Body capsule(Vec3 at, float radius, float length) {
    return {{0, length / 2, 0}, radius, at, {0, 0, 0, 1}, {}, {}};
  }

  /// `mass`: in units of m_* (the mass of a particle of level 0), 0 for a body that is not free. Returns the
  /// body's index.
  int add(const Body& body, float mass, float friction = 0) {
    FreeBody free{};
    free.mass = mass;
    const Vec3 h = body.half;
    const float round = 0.4f * body.radius * body.radius;
    const Vec3 of_box{(h.y * h.y + h.z * h.z) / 3, (h.x * h.x + h.z * h.z) / 3, (h.x * h.x + h.y * h.y) / 3};
    free.inertia = mass * (of_box + Vec3{round, round, round});
    bodies.push_back(body);
    frees.push_back(free);
    frictions.push_back(friction);
    return static_cast<int>(bodies.size()) - 1;
  }
  /// Floor at y = 0.
  void add_floor() { walls.planes[walls.count++] = {{0, 1, 0}, 0}; }
  void push(int b, Vec3 velocity) { frees[index(b)].momentum += frees[index(b)].mass * velocity; }

  void step(int times = 1) {
    for (int k = 0; k < times; ++k) {
      bodies_.from_host(bodies);
      free_.from_host(frees);
      friction_.from_host(frictions);
      by_others_.resize(bodies.size());
      guards_.resize(1);
      bool rough = false;
      for (const float coefficient : frictions) rough = rough || coefficient > 0;
      const Meeting meeting{.bodies = bodies_.data(),
                            .free = free_.data(),
                            .meshes = meshes_.size() > 0 ? meshes_.data() : nullptr,
                            .friction = friction_.data(),
                            .by_others = by_others_.data(),
                            .walls = walls,
                            .drive = {guards_.data(), {0, gravity, 0}, dt, 1e3f, true},
                            .spacing = 0.05f,
                            .count = static_cast<int>(bodies.size()),
                            .feelers = Feelers::most_of_shapes,
                            .rough = rough};
      in_one_block("meet bodies", 256, meeting.bytes(), room_, meeting);
      bodies = bodies_.to_host();
      frees = free_.to_host();
      by_others = by_others_.to_host();
    }
  }

  Vec3 velocity(int b) const { return (1 / frees[index(b)].mass) * frees[index(b)].momentum; }
  Vec3 spin(int b) const { return spin_of(frees[index(b)], bodies[index(b)].turn, frees[index(b)].spin); }
  Vec3 momentum() const {
    Vec3 out{0, 0, 0};
    for (const FreeBody& free : frees) out += free.momentum;
    return out;
  }
  /// About the origin.
  Vec3 angular_momentum() const {
    Vec3 out{0, 0, 0};
    for (std::size_t b = 0; b < bodies.size(); ++b)
      out += frees[b].spin + cross(bodies[b].centre, frees[b].momentum);
    return out;
  }
  float energy() const {
    float out = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const FreeBody& it = frees[b];
      if (it.mass == 0) continue;
      out += 0.5f * dot(it.momentum, it.momentum) / it.mass +
             0.5f * dot(it.spin, spin_of(it, bodies[b].turn, it.spin)) +
             it.mass * gravity * bodies[b].centre.y;
    }
    return out;
  }
  float gap_of_balls(int a, int b) const {
    return length(bodies[index(a)].centre - bodies[index(b)].centre) - bodies[index(a)].radius -
           bodies[index(b)].radius;
  }

  std::vector<Body> bodies;
  std::vector<FreeBody> frees;
  std::vector<float> frictions;
  std::vector<Vec3> by_others;

 private:
  static std::size_t index(int b) { return static_cast<std::size_t>(b); }
  Array<Body> bodies_;
  Array<FreeBody> free_;
  Array<MeshGrid> meshes_;
  Array<float> friction_;
  Array<Vec3> by_others_;
  Array<Guards> guards_;
  Array<unsigned char> room_;
};

}  // namespace sim::SIM_BACKEND
