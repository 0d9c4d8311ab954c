#!/usr/bin/env python3
"""Writes kernels/lib/shading/poisson_disk.clh: disks of 8, 16 and 32 taps for the thickness term.

Best-candidate points [Mitchell 1991] relaxed towards the centroids of their cells [Lloyd 1982], stopped early
so that no rings form, then moved so that their mean is the centre. Taps are ordered farthest first, so that
the first eight already cover the disk. The same run writes the same bytes. Usage: generate_disks.py > FILE
"""

import math
import random


def inside(rng):
    while True:
        x, y = rng.uniform(-1, 1), rng.uniform(-1, 1)
        if x * x + y * y <= 1:
            return (x, y)


def nearest(points, p):
    return min(range(len(points)), key=lambda i: math.dist(points[i], p))


def best_candidates(count, rng):
    points = [inside(rng)]
    while len(points) < count:
        candidates = [inside(rng) for _ in range(40 * len(points))]
        points.append(max(candidates, key=lambda c: min(math.dist(c, p) for p in points)))
    return points


def relax(points, grid):
    sums = [[0.0, 0.0, 0] for _ in points]
    for g in grid:
        cell = sums[nearest(points, g)]
        cell[0] += g[0]
        cell[1] += g[1]
        cell[2] += 1
    return [(s[0] / s[2], s[1] / s[2]) for s in sums]


def spread(points):
    """Farthest first from the one nearest to the centre."""
    rest = sorted(points, key=lambda p: math.hypot(*p))
    ordered = [rest.pop(0)]
    while rest:
        far = max(rest, key=lambda p: min(math.dist(p, q) for q in ordered))
        rest.remove(far)
        ordered.append(far)
    return ordered


def disk(count):
    rng = random.Random(count)
    cells = 96
    axis = [(i + 0.5) * 2 / cells - 1 for i in range(cells)]
    grid = [(x, y) for x in axis for y in axis if x * x + y * y <= 1]
    points = best_candidates(count, rng)
    for _ in range(10):
        points = relax(points, grid)
    mx, my = (sum(p[i] for p in points) / count for i in (0, 1))
    points = [(x - mx, y - my) for x, y in points]
    # A uniform disk has mean squared radius 1/2; cells' centroids lie a little further in.
    scale = math.sqrt(0.5 * count / sum(x * x + y * y for x, y in points))
    scale = min(scale, 1 / max(math.hypot(x, y) for x, y in points))
    return spread([(x * scale, y * scale) for x, y in points])


def main():
    print(
        "// Taps of the thickness term: points of the unit disk, evenly spread, none near another, "
        "their mean in the centre."
    )
    print("""\
// Written by bench/shading/generate_disks.py, which says how: do not edit.
#pragma once
""")
    for count in (8, 16, 32):
        print(f"__constant float2 pelDisk{count}[{count}] = {{")
        for x, y in disk(count):
            print(f"    (float2)({x:.7f}f, {y:.7f}f),")
        print("};\n")
    print("""static inline __constant float2* poissonDisk(uint taps) {
    return taps <= 8 ? pelDisk8 : taps <= 16 ? pelDisk16 : pelDisk32;
}""")


main()
