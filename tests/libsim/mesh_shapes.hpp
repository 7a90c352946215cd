#pragma once
/// Meshes with known distances and masses.

#include <cmath>
#include <numbers>
#include <string>

#include "libsim/scene/mesh.hpp"

namespace mesh_test {

/// A box between two corners as OBJ, made of six quads.
inline std::string box_text(const std::array<double, 3>& low, const std::array<double, 3>& high) {
  std::string out;
  for (int corner = 0; corner < 8; ++corner) {
    out += "v";
    for (std::size_t k = 0; k < 3; ++k)
      out += " " + std::to_string((corner >> k & 1) != 0 ? high[k] : low[k]);
    out += "\n";
  }
  return out + "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
}

/// A sphere of meridians and parallels as OBJ.
inline std::string ball_text(double radius, int parallels = 40) {
  const int round = 2 * parallels;
  std::string out = "v 0 " + std::to_string(radius) + " 0\n";
  for (int i = 1; i < parallels; ++i) {
    const double polar = std::numbers::pi * i / parallels;
    for (int k = 0; k < round; ++k) {
      const double turn = 2 * std::numbers::pi * k / round;
      out += "v " + std::to_string(radius * std::sin(polar) * std::sin(turn)) + " " +
             std::to_string(radius * std::cos(polar)) + " " +
             std::to_string(radius * std::sin(polar) * std::cos(turn)) + "\n";
    }
  }
  out += "v 0 " + std::to_string(-radius) + " 0\n";
  const int last = 2 + (parallels - 1) * round;
  const auto at = [&](int ring, int k) { return std::to_string(2 + (ring - 1) * round + k % round); };
  for (int k = 0; k < round; ++k) {
    out += "f 1 " + at(1, k) + " " + at(1, k + 1) + "\n";
    for (int ring = 1; ring + 1 < parallels; ++ring)
      out += "f " + at(ring, k) + " " + at(ring + 1, k) + " " + at(ring + 1, k + 1) + " " + at(ring, k + 1) +
             "\n";
    out += "f " + std::to_string(last) + " " + at(parallels - 1, k + 1) + " " + at(parallels - 1, k) + "\n";
  }
  return out;
}

inline sim::Triangles triangles(const std::string& text) {
  return sim::read_obj(text, [](int line, const std::string& problem, const std::string& mend) {
    throw std::runtime_error("line " + std::to_string(line) + " " + problem + "; mend: " + mend);
  });
}

}  // namespace mesh_test
