// Unit vector towards the sun, the only directional light, infinitely far away.
const vec3 sun = vec3(0.3536, 0.8130, 0.4625);
const vec3 haze = vec3(0.68, 0.77, 0.84);  // light of the air at the horizon
const float into_water = 1.0 / 1.333;  // refractive index of air / that of water

// Share of light that water reflects (Schlick); facing: cosine of the angle between ray and normal.
float reflected_share(float facing) { return 0.02 + 0.98 * pow(1.0 - facing, 5.0); }
