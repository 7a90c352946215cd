#!/bin/sh
# Computes the meshes of data/scenes/boat.toml from formulas and writes them to FOLDER/hull.obj and
# FOLDER/ring.obj.
# usage: scripts/meshes.sh [FOLDER]    default: data/meshes
set -eu
out=${1:-$(dirname "$0")/../data/meshes}
mkdir -p "$out"

# awk functions that write triangles: quad() writes two for a quadrilateral, and band() writes those between
# two closed rings of `points` vertices, whose first vertices are `from` and `to`.
triangles='
  function quad(a, b, c, d) { printf "f %d %d %d\nf %d %d %d\n", a, b, c, a, c, d }
  function band(from, to, points,   k, next_k) {
    for (k = 0; k < points; ++k) { next_k = (k + 1) % points; quad(from + k, from + next_k, to + next_k, to + k) }
  }'

# A solid hull: 1.2 m long, 0.44 m wide, 0.3 m deep; both ends are pointed, and the deck rises to them.
awk "$triangles"'
  BEGIN {
    pi = atan2(0, -1); stations = 24; points = 18; keel = 12
    print "# scripts/meshes.sh: a solid hull, x from stern to bow, y up, m"
    printf "v -0.6 %.4f 0\n", 0.08
    for (i = 1; i < stations; ++i) {
      s = -cos(pi * i / stations); full = (1 - s * s) ^ 0.6
      beam = 0.22 * full; depth = 0.3 * (1 - s ^ 4) ^ 0.5; deck = 0.08 * s * s
      for (k = 0; k < points; ++k) {
        if (k <= keel) { t = pi * k / keel; y = deck - depth * sin(t) ^ 0.7; z = beam * cos(t) }
        else { y = deck + 0.02 * full * sin(pi * (k - keel) / (points - keel)); z = beam * (2 * (k - keel) / (points - keel) - 1) }
        printf "v %.4f %.4f %.4f\n", 0.6 * s, y, z
      }
    }
    printf "v 0.6 %.4f 0\n", 0.08
    last = 2 + (stations - 1) * points
    for (k = 0; k < points; ++k) printf "f 1 %d %d\n", 2 + (k + 1) % points, 2 + k
    for (i = 0; i < stations - 2; ++i) band(2 + i * points, 2 + (i + 1) * points, points)
    for (k = 0; k < points; ++k) printf "f %d %d %d\n", last, last - points + k, last - points + (k + 1) % points
  }' >"$out/hull.obj"

# A ring: a torus about the y axis, with radii of 0.28 m (to the centre of the tube) and 0.1 m (the tube).
awk "$triangles"'
  BEGIN {
    pi = atan2(0, -1); rings = 40; points = 16
    print "# scripts/meshes.sh: a torus of 0.28 m and 0.1 m round y"
    for (i = 0; i < rings; ++i) {
      a = 2 * pi * i / rings
      for (k = 0; k < points; ++k) {
        t = 2 * pi * k / points; r = 0.28 + 0.1 * cos(t)
        printf "v %.4f %.4f %.4f\n", r * cos(a), 0.1 * sin(t), r * sin(a)
      }
    }
    for (i = 0; i < rings; ++i) band(1 + i * points, 1 + (i + 1) % rings * points, points)
  }' >"$out/ring.obj"
