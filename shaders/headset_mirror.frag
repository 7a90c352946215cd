// Draws the view of one eye, ray by ray: a page placed in the world, behind it the picture drawn for this eye, and
// black elsewhere.
layout(binding = 0) uniform sampler2D picture;  // the pictures of both eyes side by side, the left eye's first
layout(binding = 1) uniform sampler2D page;
layout(location = 0) out vec4 colour;

uniform vec2 size;    // of the image to draw, px
uniform int samples;  // samples per pixel, 4 or 1; 4 smooth letters finer than a pixel
uniform float slope;  // of the ray to the image's edge: tangent of half the field of view
uniform vec3 eye;     // position, m
uniform mat3 turn;    // the eye's axes: right, up, back
uniform int shows_picture, shows_page;
uniform mat3 picture_turn;      // the eye's axes as the picture was drawn
uniform vec4 picture_tangents;  // of the picture's field of view: left, right, down, up
uniform float picture_share;    // share of the picture's width that shows this eye's view, from the left edge
uniform float light;            // factor on the picture's levels
uniform vec3 page_middle;
uniform mat3 page_turn;
uniform vec2 page_size;  // m

bool inside(vec2 place) { return all(greaterThanEqual(place, vec2(0.0))) && all(lessThanEqual(place, vec2(1.0))); }

vec3 seen(vec3 ray) {
  if (shows_page != 0) {
    const vec3 from = (eye - page_middle) * page_turn, along = ray * page_turn;
    const float way = -from.z / along.z;
    const vec2 place = (from.xy + way * along.xy) / page_size + 0.5;
    if (from.z > 0.0 && way > 0.0 && inside(place)) return textureLod(page, place, 0.0).rgb;
  }
  if (shows_picture != 0) {
    const vec3 along = ray * picture_turn;
    const vec2 place = (along.xy / -along.z - picture_tangents.xz) / (picture_tangents.yw - picture_tangents.xz);
    if (along.z < 0.0 && inside(place))
      return light * textureLod(picture, vec2(picture_share * place.x, place.y), 0.0).rgb;
  }
  return vec3(0.0);
}

void main() {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < samples; ++i) {
    const vec2 at = gl_FragCoord.xy + (samples == 4 ? vec2(i % 2, i / 2) * 0.5 - 0.25 : vec2(0.0));
    sum += seen(turn * vec3((2.0 * at / size - 1.0) * slope, -1.0));
  }
  colour = vec4(sum / samples, 1.0);
}
