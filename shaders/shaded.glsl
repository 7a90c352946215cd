// Linear light of a pixel in two words, as half floats.
uvec2 packed_light(vec3 light) {
  const vec3 c = clamp(light, vec3(0.0), vec3(60000.0));
  return uvec2(packHalf2x16(c.rg), packHalf2x16(vec2(c.b, 0.0)));
}

vec3 unpacked_light(uvec2 words) { return vec3(unpackHalf2x16(words.x), unpackHalf2x16(words.y).x); }

vec3 encode_srgb(vec3 c) {
  const vec3 x = clamp(c, 0.0, 1.0);
  return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}
