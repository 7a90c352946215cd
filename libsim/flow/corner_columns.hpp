#pragma once
/// The source of a nozzle's water: the lowest particles in the four corner columns of the tank.

#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// The corners [low, low + edge] and [high - edge, high] in x and z, at any height.
struct Corners {
  Vec3 low{}, high{};
  float edge = 0;

  SIM_FN bool hold(Vec3 x) const {
    const bool side_x = x.x < low.x + edge || x.x > high.x - edge;
    const bool side_z = x.z < low.z + edge || x.z > high.z - edge;
    return side_x && side_z && all_finite(x);
  }
};

class CornerColumns {
 public:
  /// Orders the particles in the corners, lowest y first, ties by id: the result does not depend on the
  /// particles' order in memory. Returns their number, which is read back from the device.
  int find(Reads<Column::Position, Column::Id> particles, const Corners& corners);
  /// Indices of the particles found by `find`.
  const int* lowest_first() const { return order_.data(); }
  std::size_t bytes() const;

 private:
  Scanner scanner_;
  Sorter sorter_;
  Array<int> inside_, rank_, order_;
  Array<std::uint64_t> keys_;
};

}  // namespace sim::SIM_BACKEND
