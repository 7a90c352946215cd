#pragma once
/// The ellipsoids of all particles, for drawing. Computed only when a picture is drawn; the solver's state is
/// not changed.

#include "libsim/neighbors/grid.hpp"
#include "libsim/particles/particle_state.hpp"
#include "libsim/surface/anisotropy_yu2013.hpp"

namespace sim::SIM_BACKEND {

/// Packs the matrix Ellipsoid::square as RenderShape describes.
SIM_FN RenderShape packed(const Symmetric3& square) {
  const float scale = at_least(at_least(square.xx, square.yy), square.zz);
  const float by = scale > 0 ? 32767 / scale : 0.0f;
  const auto pair = [by](float low, float high) {
    const auto bits = [by](float x) {
      return static_cast<std::uint32_t>(static_cast<int>(floorf(x * by + 0.5f))) & 0xffffu;
    };
    return bits(low) | bits(high) << 16;
  };
  RenderShape out;
  out.word[0] = pair(square.xx, square.yy);
  out.word[1] = pair(square.zz, square.xy);
  out.word[2] = pair(square.xz, square.yz);
  memcpy(&out.word[3], &scale, sizeof scale);
  return out;
}

SIM_FN Symmetric3 unpacked(const RenderShape& shape) {
  float scale = 0;
  memcpy(&scale, &shape.word[3], sizeof scale);
  const float by = scale / 32767;
  const auto low = [by](std::uint32_t word) {
    return by * static_cast<float>(static_cast<std::int16_t>(word & 0xffffu));
  };
  const auto high = [by](std::uint32_t word) {
    return by * static_cast<float>(static_cast<std::int16_t>(word >> 16));
  };
  return {low(shape.word[0]),  high(shape.word[0]), low(shape.word[1]),
          high(shape.word[1]), low(shape.word[2]),  high(shape.word[2])};
}

/// The particles of a picture, in the back end's memory.
struct SurfaceParticles {
  int n;
  const Vec4* position;  ///< m, and the support h, m; h = 0: an unused slot
  const Vec4* velocity;  ///< m/s; nullptr: unknown
  /// Ids, which last from frame to frame; nullptr: unknown, or no particle splits or merges. Without ids the
  /// ellipsoids are those of the present water.
  const int* id;
  int most_ids;  ///< every id is below
  int frame;     ///< number of the frame
  /// Share of the way from the last frame's ellipsoids to those of the present water, (0, 1].
  float follow;
  float frame_s;  ///< duration of a frame, s
  float support;  ///< a support between the finest and the coarsest of the water, m
  Domain tank;    ///< its walls and floor, and a lid, mirror the water
  bool lid;
};

/// With ids, ellipsoids follow the present water gradually if the last picture was of the frame before, and
/// at once otherwise.
class Ellipsoids {
 public:
  /// Writes each particle's drawn centre and radius r = h / 4 to centre[i], and its ellipsoid to shape[i].
  /// Behind them it writes the particles that merged into others and fade out. Returns the number of
  /// particles written: from.n without ids; with ids up to from.most_ids.
  int compute(const SurfaceParticles& from, Vec4* centre, RenderShape* shape);

  /// The same, copied to the host.
  void read(const SurfaceParticles& from, std::vector<RenderParticle>& particles,
            std::vector<RenderShape>& shapes);

  template <class Archive>
  void keep(Archive& archive) {
    for (Drawn* one : {&before_, &now_}) archive(one->frame, one->centre, one->shape, one->motion);
  }

 private:
  /// The ellipsoids of a frame, by id, with the particle's own radius. Radius 0: no such particle; -k: a
  /// particle that fades out, in its k-th frame.
  struct Drawn {
    int frame = -1;
    Array<Vec4> centre;
    Array<RenderShape> shape;
    Array<Vec4> motion;  ///< way in a frame, m, and the drawn radius
  };
  void begin_frame(const SurfaceParticles& from);

  Drawn before_, now_;
  Array<Vec4> centre_;
  Array<RenderShape> shape_;
  Particles sorted_;  ///< copies of the positions, sorted by cell; the ids are the indices in `from`
  Grid grid_;
  Scanner scanner_;
  Array<std::uint8_t> fades_;
  Array<int> count_;
};

}  // namespace sim::SIM_BACKEND
