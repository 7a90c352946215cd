// The fields of RenderCounts (libsim/render/fluid_renderer.hpp) in the same order.
layout(std430, binding = 4) buffer Counters {
  uint not_finite;
  uint outside;
  uint beyond;
  uint near_crossing;
  uint subpixel_count;
  uint by_thread;
  uint by_group;
  uint by_tiles;
  uint filter_capped;
  uint thickness_full;
  uint front_missing;
};
