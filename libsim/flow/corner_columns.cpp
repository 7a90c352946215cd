#include "libsim/flow/corner_columns.hpp"

#include <cstring>

namespace sim::SIM_BACKEND {

namespace {

struct MarkCorners {
  const Vec4* position;
  Corners corners;
  int* inside;
  SIM_FN void operator()(int i) const { inside[i] = corners.hold(xyz(position[i])); }
};

struct ListCorners {
  const Vec4* position;
  const int* id;
  const int* inside;
  const int* rank;
  std::uint64_t* keys;
  int* order;

  SIM_FN void operator()(int i) const {
    if (!inside[i]) return;
    const int place = rank[i] - 1;
    keys[place] = std::uint64_t{ordered(position[i].y)} << 32 | static_cast<std::uint32_t>(id[i]);
    order[place] = i;
  }
  /// Bits that are ordered like the numbers.
  SIM_FN static std::uint32_t ordered(float y) {
    std::uint32_t bits = 0;
    memcpy(&bits, &y, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
  }
};

}  // namespace

int CornerColumns::find(Reads<Column::Position, Column::Id> particles, const Corners& corners) {
  const int n = particles.size();
  if (n == 0) return 0;
  inside_.resize(static_cast<std::size_t>(n));
  for_each("mark corners", n, MarkCorners{particles.position(), corners, inside_.data()});
  scanner_.inclusive_sum(inside_, rank_);
  const int found = last_of(rank_);
  keys_.resize(static_cast<std::size_t>(found));
  order_.resize(static_cast<std::size_t>(found));
  for_each("list corners", n,
           ListCorners{particles.position(), particles.id(), inside_.data(), rank_.data(), keys_.data(),
                       order_.data()});
  sorter_.sort(keys_, order_);
  return found;
}

std::size_t CornerColumns::bytes() const {
  return inside_.bytes() + rank_.bytes() + order_.bytes() + keys_.bytes();
}

}  // namespace sim::SIM_BACKEND
