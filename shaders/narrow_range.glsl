// Narrow-range filter of nearness (Truong and Yuksel 2018) on pairs of a sample and its mirror image. The range is
// centre +- width. If a sample lies behind the range, it counts as lying only `behind` behind the centre, and its
// mirror image as at most `behind` in front of the centre. If a sample lies in front of the range, the pair is
// excluded, unless the mirror image lies about as far behind the centre: the surface is then slanted, and both samples
// count.
struct Range {
  float centre, width, behind;
  float sum, weight;
};

Range start_range(float nearness, float radius) {
  const float unit = radius * nearness * nearness;  // difference of nearness over a depth of one particle radius
  return Range(nearness, narrow_range.y * unit, narrow_range.z * unit, 0.0, 1.0);
}

void add_pair(inout Range range, float a, float b, float weight) {
  const float near = max(a, b) - range.centre, far = min(a, b) - range.centre;
  float both = near + far;
  if (near > range.width) {
    // n: how far the nearer sample lies in front of the centre; f: how far the other one lies behind it. Both samples
    // count if n <= 2 f + 3/4 width and f <= 2 n + 3/4 width. Depths within a lone drop differ by less than the width,
    // so that its samples do not come into this branch.
    if (min(a, b) == 0.0 || abs(both) > 0.5 * range.width + (near - far) / 3.0) return;
  } else if (far < -range.width) {
    both = near < -range.width ? -2.0 * range.behind : min(near, range.behind) - range.behind;
  }
  range.sum += weight * both;
  range.weight += 2.0 * weight;
}

float filtered(Range range) { return range.centre + range.sum / range.weight; }
