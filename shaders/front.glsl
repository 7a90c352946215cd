// After targets.glsl.
layout(std430, binding = 2) buffer Front { uint front[]; };

// The lowest index where this depth is the pixel's, `held`.
void splat_front(Sphere s, ivec2 pixel, bool subpixel, vec4 grid, int at, uint held, uint particle) {
  if (depth_up_to(held, s, pixel, subpixel, grid) == held) atomicMin(front[at], particle);
}
