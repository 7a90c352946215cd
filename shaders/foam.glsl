// What the splats of foam leave at a pixel: optical depths in fixed point, of what lies on the water or before it
// and of what lies below its surface, dimmed by the water above.
const float foam_units = 2048.0;
