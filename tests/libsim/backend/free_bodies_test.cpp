/// Rotation of free bodies, and their contact with walls.

#include "libsim/particles/free_body.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {

namespace {

Body brick() {
  Body out{};
  out.half = {0.3f, 0.1f, 0.2f};
  out.turn = {0, 0, 0, 1};
  return out;
}
/// The mass and the inertia of a body as large as `body`, with one unit of mass in each unit of volume.
FreeBody made_of(const Body& body) {
  FreeBody out{};
  const Vec3 h = body.half;
  out.volume = 8 * h.x * h.y * h.z;
  out.mass = out.volume;
  out.inertia = (out.mass / 3) * Vec3{h.y * h.y + h.z * h.z, h.x * h.x + h.z * h.z, h.x * h.x + h.y * h.y};
  return out;
}
float energy(const Body& body, const FreeBody& free) {
  return 0.5f * dot(free.spin, spin_of(free, body.turn, free.spin));
}

/// A brick tumbles about its axis of middle inertia. The energy changes by at most 1 %.
SIM_TEST(FreeBodies, ATumblingBrickKeepsItsEnergy) {
  Body body = brick();
  FreeBody free = made_of(body);
  free.spin = {0.01f * free.inertia.x, 0.01f * free.inertia.y, 4 * free.inertia.z};
  const float before = energy(body, free);
  float tumbled = 0;
  for (int step = 0; step < 2000; ++step) {
    turn_on(body, free, 1.0f / 180);
    EXPECT_NEAR(energy(body, free) / before, 1, 0.01f);
    const Vec3 middle = turned(body.turn, {0, 0, 1});
    tumbled = std::max(tumbled, 1 - middle.z);
  }
  EXPECT_GT(tumbled, 1) << "it turned over";
  EXPECT_NEAR(dot(xyz(body.turn), xyz(body.turn)) + body.turn.w * body.turn.w, 1, 1e-5f);
}

SIM_TEST(FreeBodies, TurnsAreRightHanded) {
  const Vec4 quarter = turned_by({0, 0, 0, 1}, {0, 0, 1.57079633f});
  EXPECT_NEAR(turned(quarter, {1, 0, 0}).y, 1, 1e-6f);
}

/// A brick falls on a corner: it stops at the floor and gains a spin but no energy.
SIM_TEST(FreeBodies, WallsStopABodyWithoutEnergy) {
  Walls walls{};
  walls.planes[walls.count++] = {{0, 1, 0}, 0};
  walls.planes[walls.count++] = {{1, 0, 0}, 0};
  Body body = brick();
  body.turn = turned_by(body.turn, {0.3f, 0.2f, 0.5f});
  body.centre = {0.6f, 0.34f, 0};
  FreeBody free = made_of(body);
  free.momentum = free.mass * Vec3{-3, -4, 1};
  const auto all = [&] { return energy(body, free) + 0.5f * dot(free.momentum, free.momentum) / free.mass; };
  const float before = all();
  const Vec3 momentum = free.momentum;
  constexpr float dt = 0.02f;
  WallContact{walls, body, free, dt}.stop();
  EXPECT_LT(all(), before);
  EXPECT_GT(length(free.spin), 0.0f);
  EXPECT_LT(length(free.momentum - momentum - free.by_walls), 1e-5f * length(momentum));
  EXPECT_EQ(free.momentum.z, momentum.z) << "walls are smooth";
  turn_on(body, free, dt);
  body.centre += (dt / free.mass) * free.momentum;
  EXPECT_LT(length(WallContact{walls, body, free, dt}.way_back()), 0.01f);
}

SIM_TEST(FreeBodies, WhatLiesBeyondAWallComesBack) {
  Walls walls{};
  walls.planes[walls.count++] = {{0, 1, 0}, 0};
  Body body = brick();
  body.centre = {0, 0.04f, 0};
  FreeBody free = made_of(body);
  EXPECT_NEAR((WallContact{walls, body, free, 0.01f}.way_back().y), 0.06f, 1e-6f);
}

}  // namespace

}  // namespace sim::SIM_BACKEND
