// Include this file after targets.glsl, whose functions it calls.
layout(std430, binding = 2) buffer Front { uint front[]; };

// Lowers front[at] to this particle's index if the sphere's depth at the pixel equals `held`, the pixel's depth.
void splat_front(Sphere s, ivec2 pixel, bool subpixel, vec4 grid, int at, uint held, uint particle) {
  if (depth_up_to(held, s, pixel, subpixel, grid) == held) atomicMin(front[at], particle);
}
