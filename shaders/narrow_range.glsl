// The narrow range around a centre depth: samples in front of it are refused together with their mirror image,
// samples behind it count as a little behind the centre, and those inside widen it.
struct Range {
  float low, high;
  float delta, behind;
  float sum, weight;
};

Range start_range(float centre, float radius) {
  const float delta = narrow_range.y * radius;
  return Range(centre - delta, centre + delta, delta, centre + narrow_range.z * radius, centre, 1.0);
}

void add_pair(inout Range range, float a, float b, float weight) {
  if (min(a, b) < range.low) return;
  range.sum += weight * ((a > range.high ? range.behind : a) + (b > range.high ? range.behind : b));
  range.weight += 2.0 * weight;
  const float low = min(a, b);
  const float high = max(a <= range.high ? a : range.low, b <= range.high ? b : range.low);
  if (low <= range.high) range.low = min(range.low, low - range.delta);
  range.high = max(range.high, high + range.delta);
}
