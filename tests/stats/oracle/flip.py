#!/usr/bin/env python3
"""Prints LDR-FLIP (Andersson et al. 2020) of two made pictures, with loops and lists only.

The pictures are those of tests/stats/image_test.cpp: noise of a congruence, and a slope with noise on it.
Nothing is shared with stats/image/flip.cpp: one-dimensional passes stand where that has windows, and the
inverse of the colour matrix is computed.
"""
import math


def noise(width, height, seed):
    out = []
    for _ in range(3 * width * height):
        seed = (seed * 1664525 + 1013904223) % 2**32
        out.append(seed >> 24)
    return width, height, out


def rough(picture):
    width, height, data = picture
    return width, height, [40 + 2 * (i // 3 % width) + i // 3 // width + v // 8 for i, v in enumerate(data)]


M = [[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
     [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
     [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]]
WHITE = [sum(row) for row in M]


def inverse(m):
    a = [row[:] + [float(i == j) for j in range(3)] for i, row in enumerate(m)]
    for i in range(3):
        pivot = a[i][i]
        a[i] = [v / pivot for v in a[i]]
        for j in range(3):
            if j != i:
                a[j] = [v - a[j][i] * w for v, w in zip(a[j], a[i])]
    return [row[3:] for row in a]


M_INVERSE = inverse(M)


def times(m, v):
    return [sum(a * b for a, b in zip(row, v)) for row in m]


def decode(byte):
    v = byte / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def ycxcz(rgb):
    x, y, z = (v / w for v, w in zip(times(M, rgb), WHITE))
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)]


def rgb_of(c):
    y = (c[0] + 16) / 116
    xyz = [(y + c[1] / 500) * WHITE[0], y * WHITE[1], (y - c[2] / 200) * WHITE[2]]
    return times(M_INVERSE, xyz)


def hunt(rgb):
    f = []
    for v, w in zip(times(M, rgb), WHITE):
        t = v / w
        f.append(t ** (1 / 3) if t > (6 / 29) ** 3 else t * (29 / 6) ** 2 / 3 + 4 / 29)
    light = 116 * f[1] - 16
    return [light, 0.01 * light * 500 * (f[0] - f[1]), 0.01 * light * 200 * (f[1] - f[2])]


def hyab(a, b):
    return abs(a[0] - b[0]) + math.sqrt((a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


def along_x(plane, weights):
    r = len(weights) // 2
    return [[sum(w * row[min(max(x + k - r, 0), len(row) - 1)] for k, w in enumerate(weights))
             for x in range(len(row))] for row in plane]


def along_y(plane, weights):
    turned = [list(column) for column in zip(*plane)]
    return [list(column) for column in zip(*along_x(turned, weights))]


def both(plane, wx, wy):
    return along_y(along_x(plane, wx), wy)


def sensitivity(plane, terms, ppd):
    r = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi ** 2)) * ppd)
    total, out = 0, None
    for a, b in terms:
        g = [math.exp(-math.pi ** 2 * (k / ppd) ** 2 / b) for k in range(-r, r + 1)]
        share = a * math.sqrt(math.pi / b)
        total += share * sum(g) ** 2
        part = both(plane, g, g)
        scaled = [[share * v for v in row] for row in part]
        out = scaled if out is None else [[p + q for p, q in zip(a1, b1)] for a1, b1 in zip(out, scaled)]
    return [[v / total for v in row] for row in out]


def gradients(plane, ppd):
    sd = 0.5 * 0.082 * ppd
    r = math.ceil(3 * sd)
    g = [math.exp(-k * k / (2 * sd * sd)) for k in range(-r, r + 1)]
    edge = [-k * w for k, w in zip(range(-r, r + 1), g)]
    point = [(k * k / sd ** 2 - 1) * w for k, w in zip(range(-r, r + 1), g)]
    out = []
    for d in (edge, point):
        above = sum(v for v in d if v > 0) * sum(g)
        below = -sum(v for v in d if v < 0) * sum(g)
        up, down = [max(v, 0) / above for v in d], [min(v, 0) / below for v in d]
        d1 = [p + q for p, q in zip(up, down)]
        gx, gy = both(plane, d1, g), both(plane, g, d1)
        out.append([[math.sqrt(p * p + q * q) for p, q in zip(a, b)] for a, b in zip(gx, gy)])
    return out


def see(picture, ppd):
    width, height, data = picture
    c = [[ycxcz([decode(v) for v in data[3 * (y * width + x):][:3]]) for x in range(width)] for y in range(height)]
    planes = [[[pixel[k] for pixel in row] for row in c] for k in range(3)]
    features = gradients([[(v + 16) / 116 for v in row] for row in planes[0]], ppd)
    terms = [[(1, 0.0047)], [(1, 0.0053)], [(34.1, 0.04), (13.5, 0.025)]]
    planes = [sensitivity(p, t, ppd) for p, t in zip(planes, terms)]
    colours = [[hunt([min(max(v, 0), 1) for v in rgb_of([planes[k][y][x] for k in range(3)])])
                for x in range(width)] for y in range(height)]
    return colours, features


def flip(a, b, ppd):
    width, height = a[:2]
    (ca, fa), (cb, fb) = see(a, ppd), see(b, ppd)
    most = hyab(hunt([0, 1, 0]), hunt([0, 0, 1])) ** 0.7
    total = 0
    for y in range(height):
        for x in range(width):
            e = hyab(ca[y][x], cb[y][x]) ** 0.7
            if e < 0.4 * most:
                e = 0.95 * e / (0.4 * most)
            else:
                e = 0.95 + 0.05 * (e - 0.4 * most) / (0.6 * most)
            f = max(abs(p[y][x] - q[y][x]) for p, q in zip(fa, fb))
            total += e ** (1 - math.sqrt(f / math.sqrt(2)))
    return total / (width * height)


if __name__ == "__main__":
    a, b = noise(40, 30, 1), noise(40, 30, 2)
    for ppd in (10, 67):
        print(ppd, "noise against noise", repr(flip(a, b, ppd)))
        print(ppd, "slope against noisy slope", repr(flip(rough(a), rough(b), ppd)))
