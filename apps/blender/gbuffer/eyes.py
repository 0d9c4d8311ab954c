"""Eyes: which materials are eyeballs, where their balls are and where they look."""

import re
from math import dist

from mathutils import Matrix, Vector

from .fault import warn
from .principled import AUTO, EYE, PRESET, custom_keys

NAMED = re.compile(r"eye(ball)?s?([ ._-].*|\d*)$", re.IGNORECASE)
ADULT = 12.0  # mm, radius of the sclera that the library's other lengths belong to
LENGTHS = {"cornea_radius": 7.8, "limbus_radius": 6.0, "limbus_width": 1.0, "chamber_depth": 3.05,
           "pupil_radius": 2.0}  # mm


def is_eye(material):
    """By the preset, else by the custom property pellucid_eye, 0 or 1; without both by name: Eye, eye_left,
    Eyeball.001."""
    preset = material.get(PRESET) or AUTO
    if preset != AUTO:
        return preset == EYE
    if "pellucid_eye" in material:
        return bool(material["pellucid_eye"])
    return bool(NAMED.match(material.name))


def fit_ball(points):
    """Centre and radius of the sphere with the least squares of |p|^2 - 2 p.c - d, about the points' mean and
    in units of their extent."""
    mean = [sum(p[k] for p in points) / len(points) for k in range(3)]
    extent = max(max(abs(p[k] - mean[k]) for k in range(3)) for p in points) or 1.0
    rows = [(*(2 * (p[k] - mean[k]) / extent for k in range(3)), 1.0) for p in points]
    sums = [[sum(row[i] * row[k] for row in rows) / len(rows) for k in range(4)] for i in range(4)]
    right = [sum(row[i] * sum(c * c for c in row[:3]) / 4 for row in rows) / len(rows) for i in range(4)]
    matrix = Matrix(sums)  # of floats: a determinant below 1e-5 is that of points (almost) in a plane
    if matrix.determinant() < 1e-5:
        return None
    x = matrix.inverted() @ Vector(right)
    square = x[3] + x[0]**2 + x[1]**2 + x[2]**2
    return ([extent * x[k] + mean[k] for k in range(3)], extent * square**0.5) if square > 0 else None


def ball_of(points):
    """Centre, radius and gaze, which the cornea shows: it stands out, and is left out of the second fit."""
    found = fit_ball(points)
    if found is None:
        return None
    centre, radius = found
    for _ in range(3):
        near = [p for p in points if dist(p, centre) < 1.02 * radius]
        found = fit_ball(near) if len(near) > 8 else None
        if found is None:
            break
        centre, radius = found
    gaze = [0.0, 0.0, 0.0]
    for p in points:
        out = dist(p, centre) - 1.01 * radius
        if out > 0:
            gaze = [g + out * (p[k] - centre[k]) for k, g in enumerate(gaze)]
    length = sum(g * g for g in gaze) ** 0.5
    return centre, radius, [g / length for g in gaze] if length > 1e-3 * radius**2 else None


def find(things, unit):
    """[(material, keys of [[eye]])]. A material of several eyeballs is copied, for each eye has its own."""
    eyes, taken = [], set()
    for thing in things:
        for slot, material in enumerate(thing.data.materials):
            if material is None or not is_eye(material):
                continue
            if material.name in taken:
                material = material.copy()
                if material.pass_index:  # the next that is free
                    material.pass_index = 1 + max(m.pass_index for t in things for m in t.data.materials if m)
                thing.data.materials[slot] = material
            used = {v for face in thing.data.polygons if face.material_index == slot for v in face.vertices}
            ball = ball_of([tuple(thing.data.vertices[v].co) for v in used]) if len(used) > 8 else None
            if ball is None:
                warn(f"material '{material.name}': its faces form no ball, so it is not taken as an eye")
                continue
            taken.add(material.name)
            centre, radius, gaze = ball
            if gaze is None:
                warn(f"material '{material.name}': no cornea stands out of its ball; it looks to -y unless "
                     f"pellucid_eye_gaze says otherwise")
                gaze = [0.0, -1.0, 0.0]
            scale = radius * unit / ADULT
            keys = {"center": tuple(centre), "gaze": tuple(gaze), "up": (0.0, 0.0, 1.0),
                    "sclera_radius": scale * ADULT}
            keys.update({key: scale * length for key, length in LENGTHS.items()})
            eyes.append((material, {**keys, **custom_keys(material, "pellucid_eye_")}))
    return eyes
