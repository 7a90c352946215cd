// Narrow-range filter of nearness (Truong and Yuksel 2018) on pairs of a sample and its mirror image. The range is
// centre +- width. A sample behind the range counts as lying only `behind` behind the centre. A sample in front of
// the range excludes the pair, unless its mirror image lies about as far behind: the surface is then slanted, and
// both count.
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
    // With n in front of the centre and f behind it, both count if n <= 2 f + 3/4 width and f <= 2 n + 3/4 width.
    // Samples of a lone drop never come into this branch, because their depths differ by less than the width.
    if (min(a, b) == 0.0 || abs(both) > 0.5 * range.width + (near - far) / 3.0) return;
  } else if (far < -range.width) {
    both = near < -range.width ? -2.0 * range.behind : min(near, range.behind) - range.behind;
  }
  range.sum += weight * both;
  range.weight += 2.0 * weight;
}

float filtered(Range range) { return range.centre + range.sum / range.weight; }
