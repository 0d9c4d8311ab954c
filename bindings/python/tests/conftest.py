"""What the tests share: a device, a mesh and a G-buffer of known answers, and the table of tolerances."""
import re
from pathlib import Path

import numpy as np
import pytest
from places import ROOT
from shader_view import View

import pellucid as pel

assert ROOT / "bindings/python/pellucid" not in Path(pel.__file__).parents  # the built package is tested


@pytest.fixture(scope="session")
def device():
    return pel.Device()


@pytest.fixture
def moving_device():
    """A device that is treated as one with memory of its own, so that arrays move with each submission."""
    device = pel.Device()
    device._in_place = False
    return device


@pytest.fixture(scope="session")
def tolerance():
    """tests/tolerances.h as a dictionary."""
    text = (ROOT / "tests/tolerances.h").read_text(encoding="utf-8")
    table = {n: float(v) for n, v in re.findall(r"constexpr double (\w+) = ([0-9.e+-]+);", text)}
    assert len(table) > 10
    return table


class Mesh:
    """A sphere as latitudes and longitudes, closed at the poles by one vertex each."""

    def __init__(self, radius, rows=24, columns=48):
        theta = np.pi * np.arange(1, rows) / rows
        phi = 2 * np.pi * np.arange(columns) / columns
        ring = np.stack([np.outer(np.sin(theta), np.cos(phi)), np.outer(np.sin(theta), np.sin(phi)),
                         np.outer(np.cos(theta), np.ones(columns))], -1).reshape(-1, 3)
        normals = np.vstack([[0, 0, 1], ring, [0, 0, -1]])
        index = 1 + np.arange((rows - 1) * columns).reshape(rows - 1, columns)
        right = np.roll(index, -1, 1)
        south = len(normals) - 1
        self.triangles = np.vstack([
            np.stack([np.zeros(columns, int), index[0], right[0]], 1),
            np.stack([index[:-1], index[1:], right[:-1]], -1).reshape(-1, 3),
            np.stack([right[:-1], index[1:], right[1:]], -1).reshape(-1, 3),
            np.stack([np.full(columns, south), right[-1], index[-1]], 1)]).astype(np.uint32)
        self.normals = normals.astype(np.float32)
        self.positions = (radius * normals).astype(np.float32)


@pytest.fixture(scope="session")
def make_sphere():
    return Mesh


@pytest.fixture
def sphere(make_sphere):
    return make_sphere(10.0)


@pytest.fixture(scope="module")
def view():
    return View()
