// Paints the value of the front particle over the picture: on a scale from violet to yellow, or with one colour per
// class.
#include "view.glsl"
layout(std430, binding = 0) readonly buffer Front { uint front[]; };
layout(std430, binding = 1) readonly buffer Values { float values[]; };
layout(std430, binding = 2) readonly buffer Normals { vec4 normals[]; };
layout(location = 0) out vec4 colour;

uniform vec2 range;       // values at the ends of the colour scale
uniform bool classes;     // values are class numbers, 0 to 3
uniform uint value_count;

vec3 scale_colour(float t) {
  const vec3 stops[5] = vec3[](vec3(0.16, 0.09, 0.36), vec3(0.16, 0.33, 0.60), vec3(0.12, 0.56, 0.55),
                               vec3(0.49, 0.76, 0.32), vec3(0.98, 0.90, 0.20));
  const float at = clamp(t, 0.0, 1.0) * 4.0;
  const int low = min(int(at), 3);
  return mix(stops[low], stops[low + 1], at - float(low));
}

// Colours that differ for any colour vision (Okabe and Ito's set).
vec3 class_colour(float value) {
  const vec3 stops[4] =
      vec3[](vec3(0.90, 0.62, 0.00), vec3(0.00, 0.62, 0.45), vec3(0.34, 0.71, 0.91), vec3(0.80, 0.47, 0.65));
  return stops[clamp(int(value + 0.5), 0, 3)];
}

// Paint of the pixel, and its opacity: 0 where no painted particle is in front. NaN is painted magenta.
vec4 paint_at(ivec2 pixel) {
  const int at = pixel.y * size.x + pixel.x;
  const uint particle = front[at];
  if (particle >= value_count) return vec4(0.0);
  const float value = values[particle];
  const float facing = 0.55 + 0.45 * abs(normals[at].z);
  const vec3 paint = classes ? class_colour(value) : scale_colour((value - range.x) / (range.y - range.x));
  return vec4(value == value ? facing * paint : vec3(1.0, 0.0, 1.0), 0.8);
}

// Outlines are smooth: a pixel takes the mean of its neighbours' paint with the weights 1, 2, 1 along each axis. Inside
// a class it takes its own colour, so that each class keeps the colour of the legend.
void main() {
  const ivec2 pixel = ivec2(gl_FragCoord.xy - origin.xy);
  vec4 sum = vec4(0.0);
  for (int k = 0; k < 9; ++k) {
    const ivec2 aside = ivec2(k % 3, k / 3) - 1;
    const vec4 paint = paint_at(clamp(pixel + aside, ivec2(0), size.xy - 1));
    sum += float((2 - abs(aside.x)) * (2 - abs(aside.y))) * vec4(paint.rgb * paint.a, paint.a);
  }
  if (sum.a == 0.0) discard;
  const vec4 own = paint_at(pixel);
  colour = vec4(classes && own.a > 0.0 ? own.rgb : sum.rgb / sum.a, sum.a / 16.0);
}
