// The narrow range around a centre (Truong and Yuksel 2018), for a sample and its mirror image. Where one lies
// in front of the range, the surface goes on at a slant if the other lies about as far behind: then both count.
// Otherwise what is in front refuses both, and what is behind counts as a little behind.
struct Range {
  float centre, width, behind;
  float sum, weight;
};

Range start_range(float nearness, float radius) {
  const float unit = radius * nearness * nearness;  // a particle's radius of depth
  return Range(nearness, narrow_range.y * unit, narrow_range.z * unit, 0.0, 1.0);
}

void add_pair(inout Range range, float a, float b, float weight) {
  const float near = max(a, b) - range.centre, far = min(a, b) - range.centre;
  float both = near + far;
  if (near > range.width) {
    // Three quarters of the width aside, neither may be more than twice as far from the centre as the other. A
    // lone drop never comes here: from its rim to its nearest point it reaches less than the width.
    if (min(a, b) == 0.0 || abs(both) > 0.5 * range.width + (near - far) / 3.0) return;
  } else if (far < -range.width) {
    both = near < -range.width ? -2.0 * range.behind : min(near, range.behind) - range.behind;
  }
  range.sum += weight * both;
  range.weight += 2.0 * weight;
}

float filtered(Range range) { return range.centre + range.sum / range.weight; }
