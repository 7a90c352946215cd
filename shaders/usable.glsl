// True if x, y, z and radius (m) are finite and the radius is positive.
bool is_usable(vec4 particle) {
  const uvec4 exponent = floatBitsToUint(particle) & 0x7f800000u;
  return all(lessThan(exponent, uvec4(0x7f800000u))) && particle.w > 0.0;
}
