// Copies an sRGB picture pixel by pixel. With TO_LINEAR the copy is converted to linear light.
layout(binding = 0) uniform sampler2D picture;
uniform int x;        // first column of the picture to copy, px
uniform float light;  // factor on the picture's sRGB levels
layout(location = 0) out vec4 colour;

vec3 light_of(vec3 srgb) {  // IEC 61966-2-1
  return mix(pow((srgb + 0.055) / 1.055, vec3(2.4)), srgb / 12.92, lessThanEqual(srgb, vec3(0.04045)));
}

void main() {
  const vec3 srgb = light * texelFetch(picture, ivec2(gl_FragCoord.xy) + ivec2(x, 0), 0).rgb;
#ifdef TO_LINEAR
  colour = vec4(light_of(srgb), 1.0);
#else
  colour = vec4(srgb, 1.0);
#endif
}
