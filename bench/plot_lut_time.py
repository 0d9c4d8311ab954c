#!/usr/bin/env python3
"""Draws error against time from the JSON of bench_lut_time as SVG: plot_lut_time.py bench_lut_time.json OUT.svg"""
import json
import math
import statistics
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 720, 440, 70, 20, 40, 60
SERIES = [("ours", "#c0392b", "this library, by node count"), ("sampled row", "#2c6fbb", "sampled, the profile once a row"),
          ("sampled", "#666666", "sampled, texel by texel")]


def series(results):
    points = {name: {} for name, _, _ in SERIES}
    for b in results["benchmarks"]:
        if b.get("run_type") == "aggregate" and b.get("aggregate_name") != "median":
            continue
        fields = dict(f.split(":") for f in b["name"].split("/") if ":" in f)
        if b["name"].startswith("ours"):
            if fields["points"] == "3":  # no nearer than with two: rounding is what is left
                continue
            name, label = "ours", fields["nodes"] + ("" if fields["points"] == "2" else " (1 point)")
        elif b["name"].startswith("sampled"):
            name, label = ("sampled row" if fields["per_row"] == "1" else "sampled"), fields["samples"]
        else:
            continue
        points[name].setdefault(label, []).append((b["real_time"], b["max"]))
    return {name: [(label, statistics.median(t for t, _ in p), p[0][1]) for label, p in labels.items()]
            for name, labels in points.items()}


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        data = series(json.load(file))
    everything = [p for points in data.values() for p in points]
    x0, x1 = (f(math.log10(t) for _, t, _ in everything) for f in (min, max))
    x0, x1 = math.floor(x0 * 2) / 2 - 0.1, math.ceil(x1 * 2) / 2 + 0.1
    y0, y1 = -7.2, math.ceil(max(math.log10(e) for _, _, e in everything))
    px = lambda t: LEFT + (math.log10(t) - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT)
    py = lambda e: TOP + (y1 - math.log10(e)) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
           f'<text x="{LEFT}" y="20" font-size="14">512x512 curvature table, form arc, skin: error against device time</text>']
    for k in range(math.ceil(x0), math.floor(x1) + 1):
        x = px(10**k)
        out.append(f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{HEIGHT - BOTTOM}" stroke="#ddd"/>'
                   f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{10**k:g} ms</text>')
    for k in range(math.ceil(y0), y1 + 1):
        y = py(10.0**k)
        out.append(f'<line x1="{LEFT}" y1="{y:.1f}" x2="{WIDTH - RIGHT}" y2="{y:.1f}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">1e{k}</text>')
    for row, (name, color, title) in enumerate(SERIES):
        points = sorted(data[name], key=lambda p: p[1])
        for label, t, e in points:
            out.append(f'<circle cx="{px(t):.1f}" cy="{py(e):.1f}" r="4" fill="{color}"/>'
                       f'<text x="{px(t) + 6:.1f}" y="{py(e) - 5:.1f}" font-size="10" fill="{color}">{label}</text>')
        y = HEIGHT - 22
        x = LEFT + 225 * row
        out.append(f'<circle cx="{x}" cy="{y}" r="4" fill="{color}"/><text x="{x + 9}" y="{y + 4}">{title}</text>')
    out.append(f'<text x="16" y="{(TOP + HEIGHT - BOTTOM) / 2}" transform="rotate(-90 16 {(TOP + HEIGHT - BOTTOM) / 2})" '
               'text-anchor="middle">largest error of D</text></svg>')
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n")


main()
