// What an eye sees along each ray: a page that stands in the world, behind it the picture as it was drawn for that eye, else black.
layout(binding = 0) uniform sampler2D picture;  // both eyes', the left one's first
layout(binding = 1) uniform sampler2D page;
layout(location = 0) out vec4 colour;

uniform vec2 size;    // of what is drawn, px
uniform int samples;  // of a pixel, 4 or 1: letters are finer than pixels
uniform float slope;  // of its edges from straight ahead
uniform vec3 eye;     // m
uniform mat3 turn;    // the eye's axes: right, up, back
uniform int shows_picture, shows_page;
uniform mat3 picture_turn;      // the eye's axes as the picture was drawn
uniform vec4 picture_tangents;  // left, right, down, up
uniform float picture_share;    // of its width that is this eye's
uniform float light;            // by which its levels are multiplied
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
