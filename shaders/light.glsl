// The one light of the scene, far away: direction towards it. And how it goes into water.
const vec3 sun = vec3(0.3536, 0.8130, 0.4625);
const float into_water = 1.0 / 1.333;  // refractive index of air over water's

float reflected_share(float facing) { return 0.02 + 0.98 * pow(1.0 - facing, 5.0); }  // Schlick
