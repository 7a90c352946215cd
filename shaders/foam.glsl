// The foam passes store two optical depths per pixel in fixed point: first of foam on the water or in front of it,
// then of foam below its surface, attenuated by the water above.
const float foam_units = 2048.0;  // per unit of optical depth
