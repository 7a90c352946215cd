// Neither infinite nor NaN, and with a size: x, y, z, radius in m.
bool is_usable(vec4 particle) {
  const uvec4 exponent = floatBitsToUint(particle) & 0x7f800000u;
  return all(lessThan(exponent, uvec4(0x7f800000u))) && particle.w > 0.0;
}
