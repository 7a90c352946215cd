#pragma once
/// Numbers as 16 bit over their range: an axis of extent e has an error of at most e / 131070.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libsim/bake/bytes.hpp"

namespace sim::bake {

inline constexpr float axis_steps = 65535;

/// The range of a quantity.
struct Axis {
  float min = 0, max = 0;
};

/// Upper bound on the error of a number in this range.
inline double error_of(const Axis& range) {
  return (double(range.max) - double(range.min)) / (2 * double(axis_steps));
}

/// Maps small differences of either sign to small numbers.
inline std::uint16_t zigzag(std::uint16_t difference) {
  return static_cast<std::uint16_t>((difference << 1) ^ ((difference & 0x8000) ? 0xffff : 0));
}
inline std::uint16_t unzigzag(std::uint16_t value) {
  return static_cast<std::uint16_t>((value >> 1) ^ ((value & 1) ? 0xffff : 0));
}

/// Encodes n values as planes: n high bytes, then n low bytes, of the differences between consecutive values.
template <typename Value>
void encode_axis(std::size_t n, Value value, const Axis& range, std::uint8_t* planes) {
  const double scale = range.max > range.min ? 65535.0 / (double(range.max) - double(range.min)) : 0;
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double offset = double(value(i)) - double(range.min);
    const auto q = static_cast<std::uint16_t>(std::clamp(std::lround(offset * scale), 0L, 65535L));
    const std::uint16_t code = zigzag(static_cast<std::uint16_t>(q - before));
    planes[i] = static_cast<std::uint8_t>(code >> 8);
    planes[n + i] = static_cast<std::uint8_t>(code & 0xff);
    before = q;
  }
}

/// Accumulates the differences and passes each value to `set`.
template <typename Set>
void decode_axis(const std::uint8_t* planes, std::size_t n, const Axis& range, Set set) {
  const float scale = (range.max - range.min) / axis_steps;
  std::uint16_t q = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto code = static_cast<std::uint16_t>(planes[i] << 8 | planes[n + i]);
    q = static_cast<std::uint16_t>(q + unzigzag(code));
    set(i, range.min + scale * static_cast<float>(q));
  }
}

template <std::size_t count>
void put_axes(ByteWriter& out, const std::array<Axis, count>& axes) {
  for (const Axis& axis : axes) {
    out.put(axis.min);
    out.put(axis.max);
  }
}

template <std::size_t count>
std::array<Axis, count> get_axes(ByteReader& in) {
  std::array<Axis, count> axes{};
  for (Axis& axis : axes) {
    axis.min = in.get<float>();
    axis.max = in.get<float>();
    if (!std::isfinite(axis.min) || !std::isfinite(axis.max) || axis.max < axis.min ||
        !std::isfinite(axis.max - axis.min)) {
      in.fail("has a box that is none");
    }
  }
  return axes;
}

}  // namespace sim::bake
